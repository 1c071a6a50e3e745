//! Master programs at the other end of a real pseudo-terminal.

use super::*;
use rustix::termios::ioctl_tiocexcl;
use std::fs::File;
use std::future::poll_fn;
use std::io::{Read, Write};
use std::process::Command;
use std::time::Duration;
use tokio::time::timeout;

/// Opens the pseudo-terminal as a master program would.
fn program(path: &Path) -> File {
    rustix::fs::open(path, OFlags::RDWR | OFlags::NOCTTY, Mode::empty()).unwrap().into()
}

async fn input(pty: &mut Pty) -> (Vec<u8>, Left) {
    let mut buf = [0; 300];
    let read = timeout(Duration::from_secs(2), poll_fn(|cx| pty.poll_read(cx, &mut buf))).await;
    let Input { len, left } = read.unwrap().unwrap();
    (buf[..len].to_vec(), left)
}

/// Bytes of a program that is still there.
async fn heard(pty: &mut Pty) -> Vec<u8> {
    let (bytes, left) = input(pty).await;
    assert_eq!(left, Left::None);
    bytes
}

/// The last program has left, and nothing else has come.
async fn is_deserted(pty: &mut Pty) {
    assert_eq!(input(pty).await, (Vec::new(), Left::After));
}

async fn is_silent(pty: &mut Pty) -> bool {
    let mut buf = [0; 300];
    // A hang-up or an echo would come at once; 20 ms of silence shows that neither did.
    timeout(Duration::from_millis(20), poll_fn(|cx| pty.poll_read(cx, &mut buf))).await.is_err()
}

/// May a program without special rights open it? Root opens a locked terminal all the same, so it gives that up.
fn may_open(pty: &Pty) -> bool {
    use std::os::unix::fs::MetadataExt;
    let mut command = match std::fs::metadata("/proc/self").unwrap().uid() {
        0 => Command::new("setpriv"),
        _ => Command::new("env"),
    };
    if command.get_program() == "setpriv" {
        command.args(["--bounding-set=-sys_admin", "--inh-caps=-sys_admin"]);
    }
    let done = command.args(["sh", "-c", ": <> $0"]).arg(pty.path()).output().expect("it runs");
    let says = String::from_utf8_lossy(&done.stderr);
    assert!(done.status.success() || says.contains("busy"), "{says}");
    done.status.success()
}

fn takes(mut program: &File, count: usize) -> Vec<u8> {
    let mut buf = vec![0; count];
    program.read_exact(&mut buf).unwrap();
    buf
}

#[tokio::test]
async fn passes_every_byte_untouched_and_echoes_nothing() {
    let mut pty = Pty::open(None).unwrap();
    let mut program = program(pty.path());
    let all: Vec<u8> = (0..=255).collect();

    program.write_all(&all).unwrap();
    let mut got = Vec::new();
    while got.len() < all.len() {
        got.extend(heard(&mut pty).await);
    }
    assert_eq!(got, all);

    assert_eq!(pty.write_now(&all).unwrap(), all.len());
    assert_eq!(takes(&program, all.len()), all);
    assert!(is_silent(&mut pty).await, "an answer must not come back to us");
}

#[tokio::test]
async fn a_program_may_close_and_another_open() {
    let mut pty = Pty::open(None).unwrap();
    drop(program(pty.path()));
    is_deserted(&mut pty).await;
    assert!(is_silent(&mut pty).await, "a hang-up is told once");
    program(pty.path()).write_all(b"two").unwrap();
    assert_eq!(heard(&mut pty).await, b"two");
    is_deserted(&mut pty).await;
    assert!(is_silent(&mut pty).await);
}

#[tokio::test]
async fn leaving_wakes_a_read_that_waits() {
    let mut pty = Pty::open(None).unwrap();
    let path = pty.path().to_owned();
    let leaves = async {
        drop(program(&path));
    };
    let ((), ()) = tokio::join!(is_deserted(&mut pty), leaves);
}

/// Of several programs the last counts, however quickly they come and go.
#[tokio::test]
async fn the_last_of_several_counts() {
    let mut pty = Pty::open(None).unwrap();
    for count in [1, 2, 5, 40] {
        let mut programs: Vec<_> = (0..count).map(|_| program(pty.path())).collect();
        assert!(is_silent(&mut pty).await);
        assert!(pty.is_open_elsewhere());
        let mut last = programs.pop().unwrap();
        drop(programs);
        assert!(is_silent(&mut pty).await, "one of {count} is still there");
        last.write_all(b"x").unwrap();
        assert_eq!(heard(&mut pty).await, b"x");
        drop(last);
        is_deserted(&mut pty).await;
        assert!(!pty.is_open_elsewhere());
    }
}

/// Another program has come before the next poll: what was read is its own.
#[tokio::test]
async fn the_next_program_may_be_there_already() {
    // A child that another test has just started may keep the first one's file open for a moment.
    for _ in 0..10 {
        let mut pty = Pty::open(None).unwrap();
        let first = program(pty.path());
        assert!(is_silent(&mut pty).await);
        assert_eq!(pty.write_now(b"old").unwrap(), 3);
        drop(first);
        let mut second = program(pty.path());
        second.write_all(b"new").unwrap();
        if input(&mut pty).await == (b"new".to_vec(), Left::Before) {
            assert_eq!(rustix::io::ioctl_fionread(&second).unwrap(), 0, "nothing old waits for it");
            assert!(is_silent(&mut pty).await);
            return;
        }
    }
    panic!("the first program never leaves");
}

#[tokio::test]
async fn what_was_left_unread_is_gone_with_the_last_program() {
    let mut pty = Pty::open(None).unwrap();
    let (first, second) = (program(pty.path()), program(pty.path()));
    assert_eq!(pty.write_now(b"old").unwrap(), 3);
    drop(first);
    assert!(is_silent(&mut pty).await);
    assert_eq!(takes(&second, 1), b"o", "it is of this one, too");
    drop(second);
    is_deserted(&mut pty).await;
    let next = program(pty.path());
    assert_eq!(rustix::io::ioctl_fionread(&next).unwrap(), 0);
    assert_eq!(pty.write_now(b"new").unwrap(), 3);
    assert_eq!(takes(&next, 3), b"new");
}

/// What a program has sent before it left is told before that, in as many reads as it takes.
#[tokio::test]
async fn all_that_was_sent_comes_before_the_end() {
    let mut pty = Pty::open(None).unwrap();
    for len in [1, 299, 300, 301, 600, 900] {
        program(pty.path()).write_all(&vec![7; len]).unwrap();
        let mut got = 0;
        loop {
            let (bytes, left) = input(&mut pty).await;
            got += bytes.len();
            if left == Left::After {
                break;
            }
        }
        assert_eq!(got, len);
        assert!(is_silent(&mut pty).await);
    }
}

/// A program that has come while much of the last one was still unread loses nothing.
#[tokio::test]
async fn the_next_program_may_come_while_much_is_unread() {
    let mut pty = Pty::open(None).unwrap();
    program(pty.path()).write_all(&[7; 400]).unwrap();
    assert_eq!(input(&mut pty).await, (vec![7; 300], Left::None));
    let mut second = program(pty.path());
    second.write_all(b"new").unwrap();
    let (mut got, mut before) = (Vec::new(), 0);
    while !got.ends_with(b"new") {
        let (bytes, left) = input(&mut pty).await;
        before += usize::from(left == Left::Before);
        got.extend(bytes);
    }
    // None where a child that another test has just started keeps the first one's file open.
    assert!(got.len() == 103 && before <= 1, "{before} times, {got:?}");
    assert!(is_silent(&mut pty).await);
}

/// A lock holds as long as its holder lives, whatever passes, and no longer, even if nothing has passed.
#[tokio::test]
async fn a_lock_lives_as_long_as_its_holder() {
    let mut pty = Pty::open(None).unwrap();
    for sends in [true, false] {
        let mut holder = program(pty.path());
        ioctl_tiocexcl(&holder).unwrap();
        if sends {
            holder.write_all(b"x").unwrap();
            assert_eq!(heard(&mut pty).await, b"x");
        }
        assert!(is_silent(&mut pty).await);
        assert!(!may_open(&pty), "the holder lives");
        // As by a kill: nothing is undone.
        drop(holder);
        is_deserted(&mut pty).await;
        assert!(may_open(&pty), "it is not locked any more");
        is_deserted(&mut pty).await;
    }
}

#[tokio::test]
async fn tells_what_is_waiting_now() {
    let mut pty = Pty::open(None).unwrap();
    let mut buf = [0; 8];
    let none = Input::default();
    assert_eq!(pty.try_read(&mut buf).unwrap(), none);
    let mut program = program(pty.path());
    program.write_all(b"abc").unwrap();
    pty.master.readable().await.unwrap().retain_ready();
    assert_eq!(pty.try_read(&mut buf).unwrap(), Input { len: 3, left: Left::None });
    assert_eq!(pty.try_read(&mut buf).unwrap(), none);
    assert_eq!(poll_fn(|cx| pty.poll_read(cx, &mut [])).await.unwrap(), none);
    assert!(is_silent(&mut pty).await);
}

#[tokio::test]
async fn a_reader_that_stops_loses_bytes_and_may_resume() {
    let pty = Pty::open(None).unwrap();
    let program = program(pty.path());
    let mut taken = 0;
    loop {
        match pty.write_now(&[7; 256]).unwrap() {
            0 => break,
            count => taken += count,
        }
        assert!(taken < 10_000_000, "a full buffer must show");
    }
    assert!(taken >= 1024, "room for a few answers, found {taken}");
    assert!(takes(&program, taken).iter().all(|&byte| byte == 7));
    assert_eq!(pty.write_now(b"again").unwrap(), 5);
    assert_eq!(takes(&program, 5), b"again");
}

#[tokio::test]
async fn shows_what_the_program_has_set() {
    let pty = Pty::open(None).unwrap();
    pty.preset(19200, 2).unwrap();
    assert_eq!(pty.master_settings().unwrap(), (19200, 2));
    let program = program(pty.path());
    let mut termios = tcgetattr(&program).unwrap();
    termios.set_speed(57600).unwrap();
    termios.control_modes.remove(ControlModes::CSTOPB);
    tcsetattr(&program, OptionalActions::Now, &termios).unwrap();
    assert_eq!(pty.master_settings().unwrap(), (57600, 1));
}

#[tokio::test]
async fn is_open_under_its_link_as_long_as_it_lives() {
    let dir = tempfile::tempdir().unwrap();
    let at = dir.path().join("cell.tty");
    let mut pty = Pty::open(Some(&at)).unwrap();
    assert_eq!(pty.link(), Some(at.as_path()));
    assert_eq!(std::fs::read_link(&at).unwrap(), pty.path());
    program(&at).write_all(b"hi").unwrap();
    assert_eq!(heard(&mut pty).await, b"hi");
    drop(pty);
    assert!(!at.is_symlink());
}
