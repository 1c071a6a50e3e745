//! A drive behind an async byte stream, for tests of master libraries in the same process.
//!
//! What is served is the rig as it is by then: values, motions under way, alarms, faults and how often they have acted,
//! the scenario as far as it has come. Its time goes on from there, and is tokio's: under
//! `#[tokio::test(start_paused = true)]` a five-second watchdog takes no time at all.
//!
//! ```
//! use drivemu::model::builtin::Builtin;
//! use drivemu::testkit::{Rig, live};
//! use drivemu::wire::rtu;
//! use tokio::io::{AsyncReadExt, AsyncWriteExt};
//!
//! # #[tokio::main(flavor = "current_thread")]
//! # async fn main() -> std::io::Result<()> {
//! let drive = Rig::builtin(Builtin::default_name()).expect("an embedded model");
//! let request = rtu::encode(drive.drive().unit(), &[0x2B, 0x0E, 0x01, 0x00]);
//! let (mut master, serve) = live::stream(drive);
//! let asks = async {
//!     master.write_all(&request).await?;
//!     let mut answer = [0; 5];
//!     master.read_exact(&mut answer).await?;
//!     assert_eq!(answer[1], 0xAB, "no drive knows function 2B, so an exception answers");
//!     drop(master);
//!     std::io::Result::Ok(())
//! };
//! tokio::try_join!(serve, asks)?;
//! # Ok(())
//! # }
//! ```

use super::Rig;
use super::rig::InUse;
use crate::bus::Carrier;
use crate::server::port::{MASTER, StreamPort};
use crate::server::{Clock, LineServer, Logger};
use std::future::Future;
use std::io;
use std::path::Path;
use std::sync::{Arc, Mutex};
use tokio::io::DuplexStream;

pub use crate::server::{InboxError, LineHandle};

/// A stream to put a master on, in place of the one that asked `rig` until now, and the future that serves its drives
/// at the other end. Run the future beside the master (`tokio::spawn`, `try_join!`): the rig's time goes on when it is
/// first polled, and it ends when the stream is dropped.
pub fn stream(rig: Rig) -> (DuplexStream, impl Future<Output = io::Result<()>>) {
    let (master, _, serve) = served(rig, None);
    (master, serve)
}

/// The same, with a handle that gives commands to the line while it is served: terminals, alarms, faults.
pub fn commanded(rig: Rig) -> (DuplexStream, LineHandle, impl Future<Output = io::Result<()>>) {
    served(rig, None)
}

/// The same as [`stream`], with the event log in the file at `log`, one JSON object a line, from the beginning of the
/// rig's time. It is whole when the future has ended.
///
/// # Errors
/// If the file can't be created.
pub fn logged(
    rig: Rig,
    log: &Path,
) -> io::Result<(DuplexStream, impl Future<Output = io::Result<()>> + use<>)> {
    let (master, _, serve) = served(rig, Some(Logger::to_file(log)?));
    Ok((master, serve))
}

fn served(
    rig: Rig,
    logger: Option<Logger>,
) -> (DuplexStream, LineHandle, impl Future<Output = io::Result<()>>) {
    let (master, drive) = tokio::io::duplex(4096);
    let InUse { name, wire, bus, director, link, now, events } = rig.into_served();
    let (handle, inbox) = LineHandle::new();
    let log = logger.map(|mut logger| {
        events.iter().for_each(|event| logger.log(event, &name));
        Box::new(Arc::new(Mutex::new(logger)))
    });
    let serve = async move {
        let clock = Clock::start_at(now, 1.0);
        let mut line = LineServer::new(name, bus, wire, clock, inbox).with_director(director);
        log.into_iter().for_each(|log| line.subscribe(log));
        let port = Box::new(StreamPort::new(drive));
        line.open_for(port, Carrier::Serial, MASTER, link);
        line.serve().await
    };
    (master, handle, serve)
}
