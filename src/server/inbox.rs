//! The inbox of a line that is being served: the only input besides its masters.

use crate::bus::{Command, CommandError, Reply};
use thiserror::Error;
use tokio::sync::{mpsc, oneshot};

/// Capacity in messages; sending blocks when it is full.
const ROOM: usize = 16;

/// Gives commands to a line that is being served, from any task.
#[derive(Debug, Clone)]
pub struct LineHandle(mpsc::Sender<Message>);

/// Where they come to.
#[derive(Debug)]
pub struct Inbox(pub(super) mpsc::Receiver<Message>);

/// Something for the line.
#[derive(Debug)]
pub(super) enum Message {
    /// Carry this out and say what came of it.
    Command(Command, oneshot::Sender<Result<Reply, CommandError>>),
    /// Serve no more.
    Stop,
}

/// Why a command had no effect.
#[derive(Debug, Clone, PartialEq, Eq, Error)]
pub enum InboxError {
    /// The line did not carry it out.
    #[error(transparent)]
    Refused(#[from] CommandError),
    /// The line is not served any more.
    #[error("the line is no longer served")]
    Ended,
}

impl LineHandle {
    /// A handle, and the inbox that it leads to: a line that is served takes from there.
    pub fn new() -> (Self, Inbox) {
        let (messages, inbox) = mpsc::channel(ROOM);
        (Self(messages), Inbox(inbox))
    }

    /// Has the line carry out `command` now, and waits until it has.
    ///
    /// # Errors
    /// Why it has not.
    pub async fn command(&self, command: impl Into<Command>) -> Result<Reply, InboxError> {
        let (reply, replied) = oneshot::channel();
        let message = Message::Command(command.into(), reply);
        self.0.send(message).await.map_err(|_| InboxError::Ended)?;
        Ok(replied.await.map_err(|_| InboxError::Ended)??)
    }

    /// Has the line served no more. Its ports close with it.
    pub async fn stop(&self) {
        // Fails if it is not served any more.
        let _ = self.0.send(Message::Stop).await;
    }
}
