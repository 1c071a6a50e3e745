//! A drive behind an async byte stream, for tests of master libraries in the same process.
//!
//! The drive's time is tokio's: under `#[tokio::test(start_paused = true)]` a five-second watchdog takes no
//! time at all.
//!
//! ```
//! use drivemu::testkit::{Rig, live};
//! use tokio::io::{AsyncReadExt, AsyncWriteExt};
//!
//! # #[tokio::main(flavor = "current_thread")]
//! # async fn main() -> std::io::Result<()> {
//! let drive = Rig::builtin("yako-closed-loop").expect("an embedded model");
//! let (mut master, serve) = live::stream(drive);
//! let asks = async {
//!     master.write_all(&[0x01, 0x03, 0x00, 0x23, 0x00, 0x01, 0x75, 0xC0]).await?;
//!     let mut answer = [0; 7];
//!     master.read_exact(&mut answer).await?;
//!     assert_eq!(answer[..5], [0x01, 0x03, 0x02, 0x00, 0x3C]);
//!     drop(master);
//!     std::io::Result::Ok(())
//! };
//! tokio::try_join!(serve, asks)?;
//! # Ok(())
//! # }
//! ```

use super::Rig;
use crate::shell::{Clock, Served, serve_stream};
use std::future::Future;
use std::io;
use tokio::io::DuplexStream;

/// A stream to put a master on, and the future that serves the drives of `rig` at its other end. Run the
/// future beside the master (`tokio::spawn`, `try_join!`); it ends when the stream is dropped.
pub fn stream(rig: Rig) -> (DuplexStream, impl Future<Output = io::Result<()>>) {
    let (master, drive) = tokio::io::duplex(4096);
    let (bus, framing) = rig.into_bus();
    let serve = async move {
        let clock = Clock::start(1.0);
        let line = Served { name: "line".into(), bus, clock, framing, log: None };
        serve_stream(line, drive).await
    };
    (master, serve)
}
