//! Master programs at the other end of a real pseudo-terminal.

use super::*;
use rustix::termios::ioctl_tiocexcl;
use std::fs::File;
use std::io::{Read, Write};
use std::time::Duration;
use tokio::time::timeout;

/// Opens the pseudo-terminal as a master program would.
fn program(path: &Path) -> File {
    rustix::fs::open(path, OFlags::RDWR | OFlags::NOCTTY, Mode::empty()).unwrap().into()
}

async fn heard(pty: &Pty) -> Vec<u8> {
    let mut buf = [0; 300];
    let count = timeout(Duration::from_secs(2), pty.read(&mut buf)).await.unwrap().unwrap();
    buf[..count].to_vec()
}

async fn is_silent(pty: &Pty) -> bool {
    let mut buf = [0; 300];
    // A hang-up or an echo would come at once; 20 ms of silence shows that neither did.
    timeout(Duration::from_millis(20), pty.read(&mut buf)).await.is_err()
}

fn takes(mut program: &File, count: usize) -> Vec<u8> {
    let mut buf = vec![0; count];
    program.read_exact(&mut buf).unwrap();
    buf
}

#[tokio::test]
async fn passes_every_byte_untouched_and_echoes_nothing() {
    let pty = Pty::open(None).unwrap();
    let mut program = program(pty.path());
    let all: Vec<u8> = (0..=255).collect();

    program.write_all(&all).unwrap();
    let mut got = Vec::new();
    while got.len() < all.len() {
        got.extend(heard(&pty).await);
    }
    assert_eq!(got, all);

    assert_eq!(pty.write_now(&all).unwrap(), all.len());
    assert_eq!(takes(&program, all.len()), all);
    assert!(is_silent(&pty).await, "an answer must not come back to us");
}

#[tokio::test]
async fn a_program_may_close_and_another_open() {
    let pty = Pty::open(None).unwrap();
    drop(program(pty.path()));
    // While we wait, so that a hang-up would be seen.
    let reopen = async {
        assert!(is_silent(&pty).await);
        program(pty.path()).write_all(b"two").unwrap();
    };
    let (heard, ()) = tokio::join!(heard(&pty), reopen);
    assert_eq!(heard, b"two");
}

/// Shows its worth without root only: root opens a locked terminal all the same.
#[tokio::test]
async fn a_program_killed_with_the_port_locked_does_not_lock_out_the_next() {
    let pty = Pty::open(None).unwrap();
    let mut killed = program(pty.path());
    ioctl_tiocexcl(&killed).unwrap();
    killed.write_all(b"x").unwrap();
    assert_eq!(heard(&pty).await, b"x");
    drop(killed);
    program(pty.path());
}

#[tokio::test]
async fn tells_what_is_waiting_now() {
    let pty = Pty::open(None).unwrap();
    let mut buf = [0; 8];
    assert_eq!(pty.try_read(&mut buf).unwrap(), 0);
    program(pty.path()).write_all(b"abc").unwrap();
    pty.master.readable().await.unwrap().retain_ready();
    assert_eq!(pty.try_read(&mut buf).unwrap(), 3);
    assert_eq!(pty.try_read(&mut buf).unwrap(), 0);
    assert_eq!(pty.read(&mut []).await.unwrap(), 0);
    assert!(is_silent(&pty).await);
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
    let pty = Pty::open(Some(&at)).unwrap();
    assert_eq!(pty.link(), Some(at.as_path()));
    assert_eq!(std::fs::read_link(&at).unwrap(), pty.path());
    program(&at).write_all(b"hi").unwrap();
    assert_eq!(heard(&pty).await, b"hi");
    drop(pty);
    assert!(!at.is_symlink());
}
