//! Listener and clients over loopback sockets.

use super::*;
use std::future::poll_fn;
use std::time::Duration;
use tokio::io::{AsyncReadExt, AsyncWriteExt};
use tokio::time::timeout;

fn listener() -> (Listener, SocketAddr) {
    let listener = Listener::bind("127.0.0.1:0").unwrap();
    let addr = listener.local_addr().unwrap();
    (listener, addr)
}

async fn next(listener: &mut Listener) -> TcpEvent {
    timeout(Duration::from_secs(5), poll_fn(|cx| listener.poll_next(cx))).await.expect("no event")
}

async fn connect(listener: &mut Listener, addr: SocketAddr) -> (TcpStream, ClientId) {
    let stream = TcpStream::connect(addr).await.unwrap();
    loop {
        if let TcpEvent::Opened(id, peer) = next(listener).await {
            assert_eq!(peer, stream.local_addr().unwrap());
            return (stream, id);
        }
    }
}

async fn received(listener: &mut Listener) -> (ClientId, Vec<u8>) {
    match next(listener).await {
        TcpEvent::Bytes(id, bytes) => (id, bytes),
        other => panic!("{other:?}"),
    }
}

async fn closed(listener: &mut Listener) -> (ClientId, Option<io::Error>) {
    match next(listener).await {
        TcpEvent::Closed(id, error) => (id, error),
        other => panic!("{other:?}"),
    }
}

async fn takes(stream: &mut TcpStream, count: usize) -> Vec<u8> {
    let mut buf = vec![0; count];
    timeout(Duration::from_secs(5), stream.read_exact(&mut buf)).await.unwrap().unwrap();
    buf
}

#[tokio::test]
async fn every_client_gets_its_own_answers() {
    let (mut listener, addr) = listener();
    let mut clients = Vec::new();
    for _ in 0..10 {
        clients.push(connect(&mut listener, addr).await);
    }
    for (n, (stream, _)) in clients.iter_mut().enumerate() {
        stream.write_all(&[n as u8; 12]).await.unwrap();
    }
    for _ in 0..clients.len() {
        let (id, bytes) = received(&mut listener).await;
        assert_eq!(clients[usize::from(bytes[0])].1, id);
        listener.send(id, &bytes);
    }
    for (n, (stream, _)) in clients.iter_mut().enumerate() {
        assert_eq!(takes(stream, 12).await, [n as u8; 12]);
    }
}

#[tokio::test]
async fn answers_stay_in_order_while_a_client_is_behind() {
    let (mut listener, addr) = listener();
    let (stream, id) = connect(&mut listener, addr).await;
    let client = &listener.clients[&id];
    let answer = |n: u32| [&n.to_be_bytes()[..], &[0; 252]].concat();
    let mut sent = 0;
    // Fill the connection until some answers wait for the writer, and stop short of too many.
    while client.waiting() < 3 * 256 {
        client.send(&answer(sent)).unwrap();
        sent += 1;
    }
    // Make room and send at the moment at which the writer could, but has not yet: the new answer must not
    // overtake those that wait.
    let mut stream = stream.into_std().unwrap();
    stream.set_nonblocking(false).unwrap();
    let half = (sent as usize * 256 - client.waiting()) / 2;
    let mut got = vec![0; half];
    std::io::Read::read_exact(&mut stream, &mut got).unwrap();
    client.has_room().await;
    assert_ne!(client.waiting(), 0);
    client.send(&answer(sent)).unwrap();
    sent += 1;

    stream.set_nonblocking(true).unwrap();
    let mut stream = TcpStream::from_std(stream).unwrap();
    got.extend(takes(&mut stream, sent as usize * 256 - half).await);
    for (n, got) in (0..sent).zip(got.chunks(256)) {
        assert_eq!(got[..4], n.to_be_bytes());
    }
    listener.send(id, b"fresh");
    assert_eq!(takes(&mut stream, 5).await, b"fresh");
}

#[tokio::test]
async fn a_client_that_stops_reading_is_given_up_and_holds_up_nobody() {
    let (mut listener, addr) = listener();
    let (mut lazy, lazy_id) = connect(&mut listener, addr).await;
    let (mut keen, keen_id) = connect(&mut listener, addr).await;
    lazy.write_all(b"unread").await.unwrap();
    while listener.clients.contains_key(&lazy_id) {
        listener.send(lazy_id, &[7; 4096]);
        listener.send(keen_id, b"k");
        assert_eq!(takes(&mut keen, 1).await, b"k");
    }
    // What it had sent comes after its end, and must not be told.
    let (id, error) = closed(&mut listener).await;
    assert_eq!(id, lazy_id);
    assert!(error.unwrap().to_string().starts_with("stopped reading: "));
    keen.write_all(b"alive").await.unwrap();
    assert_eq!(received(&mut listener).await, (keen_id, b"alive".to_vec()));
}

#[tokio::test]
async fn a_flood_stays_on_the_clients_side() {
    let (mut listener, addr) = listener();
    let (mut flood, flood_id) = connect(&mut listener, addr).await;
    let (mut other, other_id) = connect(&mut listener, addr).await;
    let flooding = tokio::spawn(async move {
        loop {
            flood.write_all(&[0; 64 * 1024]).await.unwrap();
        }
    });
    // Wait until the queue is full of it.
    while listener.reports.len() < EVENTS {
        tokio::task::yield_now().await;
    }
    other.write_all(b"me too").await.unwrap();
    for told in 0.. {
        let (id, bytes) = received(&mut listener).await;
        assert!(listener.reports.len() <= EVENTS);
        if id == other_id {
            assert_eq!(bytes, b"me too");
            break;
        }
        assert_eq!(id, flood_id);
        // The queue, what each reader holds, and some turns until its bytes are noticed.
        assert!(told < 10 * EVENTS, "starved");
    }
    flooding.abort();
}

#[tokio::test]
async fn a_client_that_only_stops_sending_still_gets_its_answer() {
    let (mut listener, addr) = listener();
    let (mut stream, id) = connect(&mut listener, addr).await;
    stream.write_all(b"last").await.unwrap();
    stream.shutdown().await.unwrap();
    assert_eq!(received(&mut listener).await.1, b"last");
    listener.send(id, b"answer");
    let (gone, error) = closed(&mut listener).await;
    assert!(gone == id && error.is_none());
    listener.send(id, b"too late");
    let mut rest = Vec::new();
    stream.read_to_end(&mut rest).await.unwrap();
    assert_eq!(rest, b"answer");
}

#[tokio::test]
async fn a_broken_connection_and_a_close_of_ours_are_told_once() {
    let (mut listener, addr) = listener();
    let (stream, id) = connect(&mut listener, addr).await;
    stream.set_zero_linger().unwrap(); // makes the close a reset
    drop(stream);
    let (gone, error) = closed(&mut listener).await;
    assert_eq!((gone, error.unwrap().kind()), (id, ErrorKind::ConnectionReset));
    listener.close(id);

    let (mut stream, id) = connect(&mut listener, addr).await;
    listener.close(id);
    listener.close(id);
    let (gone, error) = closed(&mut listener).await;
    assert!(gone == id && error.is_none());
    assert_eq!(stream.read(&mut [0; 8]).await.unwrap(), 0);
    assert!(
        timeout(Duration::from_millis(20), poll_fn(|cx| listener.poll_next(cx))).await.is_err()
    );
}

/// The one that has been silent longest gives way: first those that never said a word, oldest first.
#[tokio::test]
async fn one_too_many_displaces_the_most_silent() {
    let (mut listener, addr) = listener();
    let mut clients = Vec::new();
    for _ in 0..MAX_CLIENTS {
        clients.push(connect(&mut listener, addr).await);
    }
    // All speak but number 5; number 3 again.
    for n in (0..MAX_CLIENTS).filter(|n| *n != 5).chain([3]) {
        clients[n].0.write_all(b"?").await.unwrap();
        assert_eq!(received(&mut listener).await.0, clients[n].1);
    }
    for n in [5, 0, 1, 2, 4] {
        let (mut late, late_id) = {
            let stream = TcpStream::connect(addr).await.unwrap();
            let TcpEvent::Displaced(gone) = next(&mut listener).await else { panic!("none") };
            assert_eq!(gone, clients[n].1, "number {n}");
            let TcpEvent::Opened(id, peer) = next(&mut listener).await else { panic!("not in") };
            assert_eq!(peer, stream.local_addr().unwrap());
            (stream, id)
        };
        assert_eq!(clients[n].0.read(&mut [0; 8]).await.unwrap(), 0, "the end");
        late.write_all(b"hello").await.unwrap();
        assert_eq!(received(&mut listener).await, (late_id, b"hello".to_vec()));
        listener.send(late_id, b"answer");
        assert_eq!(takes(&mut late, 6).await, b"answer");
        clients.push((late, late_id));
        assert_eq!(listener.clients.len(), MAX_CLIENTS);
    }
    // Where there is room no client is disconnected.
    let (last, id) = clients.pop().unwrap();
    drop(last);
    assert_eq!(closed(&mut listener).await.0, id);
    connect(&mut listener, addr).await;
}

#[tokio::test]
async fn a_silent_peer_is_asked_whether_it_is_there() {
    use rustix::net::sockopt;
    let (mut listener, addr) = listener();
    let (_stream, id) = connect(&mut listener, addr).await;
    let stream = listener.clients[&id].stream();
    assert!(sockopt::socket_keepalive(stream).unwrap());
    let within = sockopt::tcp_keepidle(stream).unwrap()
        + sockopt::tcp_keepintvl(stream).unwrap() * sockopt::tcp_keepcnt(stream).unwrap();
    assert_eq!(within, Duration::from_secs(60));
}

#[tokio::test]
async fn a_cancelled_wait_loses_nothing() {
    let (mut listener, addr) = listener();
    let (mut stream, _) = connect(&mut listener, addr).await;
    let writing = tokio::spawn(async move {
        for n in 0..200u8 {
            stream.write_all(&[n]).await.unwrap();
            tokio::task::yield_now().await;
        }
        stream
    });
    let mut got = Vec::new();
    while got.len() < 200 {
        tokio::select! {
            biased;
            event = poll_fn(|cx| listener.poll_next(cx)) => match event {
                TcpEvent::Bytes(_, bytes) => got.extend(bytes),
                other => panic!("{other:?}"),
            },
            () = tokio::task::yield_now() => {}
        }
    }
    assert!(got.into_iter().eq(0..200));
    writing.await.unwrap();
}

#[tokio::test]
async fn out_of_connections_it_says_so_once_and_rests() {
    let (mut listener, addr) = listener();
    let (stream, _) = connect(&mut listener, addr).await;
    let full = io::Error::from(rustix::io::Errno::MFILE);
    assert!(matches!(listener.not_accepted(full), Some(TcpEvent::NotAccepting(_))));
    let _waiting = TcpStream::connect(addr).await.unwrap();
    assert!(
        timeout(Duration::from_millis(20), poll_fn(|cx| listener.poll_next(cx))).await.is_err()
    );
    drop(stream);
    closed(&mut listener).await;
    assert!(matches!(next(&mut listener).await, TcpEvent::Opened(..)));
    assert!(listener.not_accepted(ErrorKind::ConnectionAborted.into()).is_none());
    assert!(listener.accepting);
}

#[tokio::test]
async fn refuses_in_clear_words() {
    let (_listener, addr) = listener();
    let taken = addr.to_string();
    for (addr, kind, words) in [
        (&*taken, ErrorKind::AddrInUse, "address in use"),
        ("5020", ErrorKind::InvalidInput, "expected HOST:PORT"),
        ("192.0.2.1:0", ErrorKind::AddrNotAvailable, "not an address of this machine"),
    ] {
        let refused = Listener::bind(addr).unwrap_err();
        assert_eq!(refused.kind(), kind, "{refused}");
        let text = refused.to_string();
        assert!(text.contains(words) && text.contains(addr), "{text}");
    }
}

#[tokio::test]
async fn dropping_it_closes_everything() {
    let (mut listener, addr) = listener();
    let (mut stream, _) = connect(&mut listener, addr).await;
    drop(listener);
    assert_eq!(stream.read(&mut [0; 8]).await.unwrap(), 0);
    assert!(TcpStream::connect(addr).await.is_err());
}
