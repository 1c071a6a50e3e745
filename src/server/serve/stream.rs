//! Serves a line on any async byte stream: an in-process pipe, for tests of master libraries.

use super::{LineServer, Send};
use crate::bus::LinkId;
use std::io;
use tokio::io::{AsyncRead, AsyncReadExt, AsyncWrite, AsyncWriteExt};

/// Serves `link` of `line` on `stream` until its other end is dropped.
///
/// # Errors
/// What the stream says.
pub async fn serve_stream(
    mut line: LineServer,
    link: LinkId,
    mut stream: impl AsyncRead + AsyncWrite + Unpin,
) -> io::Result<()> {
    let mut buffer = [0; 1024];
    loop {
        while let Some(send) = line.next_send() {
            match send {
                // A reply may have been held until nobody was there any more.
                Send::Frame(_, frame) => match stream.write_all(&frame).await {
                    Err(error) if error.kind() == io::ErrorKind::BrokenPipe => return Ok(()),
                    written => written?,
                },
                Send::Close(_) => return Ok(()),
                Send::Move(_) => {}
            }
        }
        tokio::select! {
            biased;
            read = stream.read(&mut buffer) => match read? {
                0 => return Ok(()),
                len => line.receive(link, &buffer[..len]),
            },
            () = line.woken() => line.advance(),
        }
    }
}
