//! A writer behind a queue, in a thread of its own: whoever gives it a text never waits, whatever reads it.
//!
//! A pipe that nobody reads, a FIFO that nobody has opened and a full disk must not stop a drive. Texts queue up to a
//! limit; beyond it they are lost and counted.

use crate::time::Duration;
use std::io::{self, BufWriter, Write};
use std::sync::mpsc::{
    Receiver, RecvTimeoutError, SyncSender, TryRecvError, TrySendError, sync_channel,
};

/// How long the end of a run waits for a slow reader to take the last texts.
const LAST_TEXTS: Duration = Duration::from_secs(1);

/// What a writer writes to: opened in its thread, as that may wait for a reader.
pub type Open = Box<dyn FnOnce() -> io::Result<Box<dyn Write>> + Send>;

/// A writer.
#[derive(Debug)]
pub struct Sink {
    /// `None` once it is told to end, or has ended by itself.
    queue: Option<SyncSender<String>>,
    lost: u64,
    ended: Receiver<io::Result<()>>,
    failure: Option<io::Error>,
}

impl Sink {
    /// Starts one for what `open` opens; `room` texts may wait.
    ///
    /// # Errors
    /// If the system has no thread to give.
    pub fn start(name: &str, room: usize, open: Open) -> io::Result<Self> {
        let (queue, texts) = sync_channel(room);
        let (end, ended) = sync_channel(1);
        std::thread::Builder::new().name(name.into()).spawn(move || {
            let result = open().and_then(|output| write(&texts, output));
            // Fails if nobody waits for it any more.
            let _ = end.send(result);
        })?;
        Ok(Self { queue: Some(queue), lost: 0, ended, failure: None })
    }

    /// Gives it a text, if there is room.
    pub fn put(&mut self, text: String) {
        let Some(queue) = &self.queue else { return };
        match queue.try_send(text) {
            Ok(()) => {}
            Err(TrySendError::Full(_)) => self.lost += 1,
            Err(TrySendError::Disconnected(_)) => self.queue = None,
        }
    }

    /// Texts that were lost since this was last 0, once there is room for a word about them.
    pub fn lost(&self) -> u64 {
        self.lost
    }

    /// Gives it a word about what was lost; without room for it that is one more.
    pub fn tell_lost(&mut self, text: String) {
        let before = std::mem::take(&mut self.lost);
        self.put(text);
        if self.lost > 0 {
            self.lost += before;
        }
    }

    /// Nothing more will come: a reader sees the end.
    pub fn close(&mut self) {
        self.queue = None;
    }

    /// Why it has ended by itself, told once.
    pub fn has_failed(&mut self) -> Option<&io::Error> {
        if self.failure.is_some() {
            return None;
        }
        match self.ended.try_recv() {
            Ok(Err(error)) => {
                self.queue = None;
                self.failure = Some(error);
                self.failure.as_ref()
            }
            Ok(Ok(())) | Err(TryRecvError::Empty | TryRecvError::Disconnected) => None,
        }
    }

    /// Waits, not for long, until everything is written.
    ///
    /// # Errors
    /// Why it is not: `TimedOut` if nobody has read it.
    pub fn finish(mut self) -> io::Result<()> {
        self.queue = None;
        if let Some(error) = self.failure {
            return Err(error);
        }
        match self.ended.recv_timeout(LAST_TEXTS) {
            Ok(result) => result,
            Err(RecvTimeoutError::Timeout) => {
                Err(io::Error::new(io::ErrorKind::TimedOut, "not being read"))
            }
            Err(RecvTimeoutError::Disconnected) => Err(io::Error::other("its writer has failed")),
        }
    }
}

fn write(texts: &Receiver<String>, output: Box<dyn Write>) -> io::Result<()> {
    let mut output = BufWriter::new(output);
    while let Ok(text) = texts.recv() {
        output.write_all(text.as_bytes())?;
        // One flush for all that has queued up meanwhile.
        while let Ok(text) = texts.try_recv() {
            output.write_all(text.as_bytes())?;
        }
        output.flush()?;
    }
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::sync::{Arc, Mutex, mpsc};

    #[derive(Clone, Default)]
    struct Page(Arc<Mutex<Vec<u8>>>);

    impl Write for Page {
        fn write(&mut self, bytes: &[u8]) -> io::Result<usize> {
            self.0.lock().unwrap().extend(bytes);
            Ok(bytes.len())
        }

        fn flush(&mut self) -> io::Result<()> {
            Ok(())
        }
    }

    #[test]
    fn everything_is_written_by_the_end() {
        let page = Page::default();
        let into = page.clone();
        let mut sink = Sink::start("t", 100, Box::new(move || Ok(Box::new(into)))).unwrap();
        (0..100).for_each(|n| sink.put(format!("{n} ")));
        sink.finish().unwrap();
        let text = String::from_utf8(page.0.lock().unwrap().clone()).unwrap();
        assert_eq!(text.split_whitespace().count(), 100);
    }

    #[test]
    fn what_nobody_reads_is_lost_and_counted() {
        let (open, opened) = mpsc::channel::<()>();
        let wait = move || {
            let _ = opened.recv();
            Ok(Box::new(Page::default()) as Box<dyn Write>)
        };
        let mut sink = Sink::start("t", 2, Box::new(wait)).unwrap();
        (0..5).for_each(|n| sink.put(n.to_string()));
        assert_eq!(sink.lost(), 3);
        sink.tell_lost("lost".into());
        assert_eq!(sink.lost(), 4, "no room for that either");
        assert!(sink.has_failed().is_none());
        assert_eq!(sink.finish().unwrap_err().kind(), io::ErrorKind::TimedOut);
        drop(open);
    }

    #[test]
    fn a_failure_is_told_once_and_at_the_end() {
        let refuse = || Err(io::Error::from(io::ErrorKind::StorageFull));
        let mut sink = Sink::start("t", 2, Box::new(refuse)).unwrap();
        while sink.has_failed().is_none() {
            std::thread::yield_now();
        }
        assert!(sink.has_failed().is_none());
        sink.put("late".into());
        assert_eq!(sink.finish().unwrap_err().kind(), io::ErrorKind::StorageFull);
    }
}
