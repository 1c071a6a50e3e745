//! A writer behind a queue, in a thread of its own: whoever gives it something to write never waits, whatever reads it.
//!
//! A pipe that nobody reads, a FIFO that nobody has opened and a full disk must not stop a drive. What is to be written
//! queues up to a limit as it is, and is made into text by the thread; beyond the limit it is lost and counted.

use crate::time::Duration;
use std::collections::VecDeque;
use std::io::{self, BufWriter, Write};
use std::sync::mpsc::{Receiver, RecvTimeoutError, TryRecvError, sync_channel};
use std::sync::{Arc, Condvar, Mutex, MutexGuard, PoisonError};

/// How long the end of a run waits for a slow reader to take the last texts.
const LAST_TEXTS: Duration = Duration::from_secs(1);

/// What a writer writes to: opened in its thread, as that may wait for a reader.
pub type Open = Box<dyn FnOnce() -> io::Result<Box<dyn Write>> + Send>;

/// Something that a writer makes into text.
pub trait Writable: Send + 'static {
    /// Writes it.
    ///
    /// # Errors
    /// What the output says.
    fn write_to(&self, output: &mut dyn Write) -> io::Result<()>;
}

impl Writable for String {
    fn write_to(&self, output: &mut dyn Write) -> io::Result<()> {
        output.write_all(self.as_bytes())
    }
}

/// A writer.
#[derive(Debug)]
pub struct Sink<T> {
    queue: Arc<SinkQueue<T>>,
    room: usize,
    lost: u64,
    ended: Receiver<io::Result<()>>,
    failure: Option<io::Error>,
}

/// What waits to be written. Its room is made once, as it is needed, and used again.
#[derive(Debug)]
struct SinkQueue<T> {
    waiting: Mutex<Waiting<T>>,
    changed: Condvar,
}

#[derive(Debug)]
struct Waiting<T> {
    items: VecDeque<T>,
    /// Nothing more comes, or nothing more is written.
    closed: bool,
}

impl<T> SinkQueue<T> {
    fn lock(&self) -> MutexGuard<'_, Waiting<T>> {
        // Nothing in here panics while it is locked.
        self.waiting.lock().unwrap_or_else(PoisonError::into_inner)
    }

    fn close(&self) {
        self.lock().closed = true;
        self.changed.notify_one();
    }

    /// Waits for items and takes all of them, in exchange for what `taken` was. Will there be more?
    fn take(&self, taken: &mut VecDeque<T>) -> bool {
        let waiting = self.lock();
        let idle = |it: &mut Waiting<T>| it.items.is_empty() && !it.closed;
        let waiting = self.changed.wait_while(waiting, idle);
        let mut waiting = waiting.unwrap_or_else(PoisonError::into_inner);
        std::mem::swap(&mut waiting.items, taken);
        !taken.is_empty()
    }
}

impl<T: Writable> Sink<T> {
    /// Starts one for what `open` opens; `room` items may wait.
    ///
    /// # Errors
    /// If the system has no thread to give.
    pub fn start(name: &str, room: usize, open: Open) -> io::Result<Self> {
        let waiting = Mutex::new(Waiting { items: VecDeque::new(), closed: false });
        let queue = Arc::new(SinkQueue { waiting, changed: Condvar::new() });
        let (end, ended) = sync_channel(1);
        let from = queue.clone();
        std::thread::Builder::new().name(name.into()).spawn(move || {
            let result = open().and_then(|output| write(&from, output));
            from.close();
            // Fails if nobody waits for it any more.
            let _ = end.send(result);
        })?;
        Ok(Self { queue, room, lost: 0, ended, failure: None })
    }

    /// Gives it an item, if there is room.
    pub fn put(&mut self, item: T) {
        let mut waiting = self.queue.lock();
        if waiting.closed {
            return;
        }
        if waiting.items.len() == self.room {
            self.lost += 1;
            return;
        }
        waiting.items.push_back(item);
        drop(waiting);
        self.queue.changed.notify_one();
    }

    /// Items that were lost since this was last 0, once there is room for a word about them.
    pub fn lost(&self) -> u64 {
        self.lost
    }

    /// Gives it a word about what was lost; without room for it that is one more.
    pub fn tell_lost(&mut self, item: T) {
        let before = std::mem::take(&mut self.lost);
        self.put(item);
        if self.lost > 0 {
            self.lost += before;
        }
    }

    /// Nothing more will come: a reader sees the end.
    pub fn close(&mut self) {
        self.queue.close();
    }

    /// Why it has ended by itself, told once.
    pub fn has_failed(&mut self) -> Option<&io::Error> {
        if self.failure.is_some() {
            return None;
        }
        match self.ended.try_recv() {
            Ok(Err(error)) => {
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
    pub fn finish(self) -> io::Result<()> {
        self.queue.close();
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

fn write<T: Writable>(queue: &SinkQueue<T>, output: Box<dyn Write>) -> io::Result<()> {
    let mut output = BufWriter::new(output);
    let mut items = VecDeque::new();
    while queue.take(&mut items) {
        for item in items.drain(..) {
            item.write_to(&mut output)?;
        }
        // One flush for all that had queued up.
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
        let mut sink = Sink::<String>::start("t", 2, Box::new(refuse)).unwrap();
        while sink.has_failed().is_none() {
            std::thread::yield_now();
        }
        assert!(sink.has_failed().is_none());
        sink.put("late".into());
        assert_eq!(sink.finish().unwrap_err().kind(), io::ErrorKind::StorageFull);
    }
}
