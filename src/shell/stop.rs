//! The signals that end a run.

/// Waits until somebody wants the run to end (SIGINT or SIGTERM) and says which it was.
pub async fn requested() -> &'static str {
    use tokio::signal::unix::{SignalKind, signal};
    let (int, term) = (signal(SignalKind::interrupt()), signal(SignalKind::terminate()));
    match (int, term) {
        (Ok(mut int), Ok(mut term)) => tokio::select! {
            _ = int.recv() => "SIGINT",
            _ = term.recv() => "SIGTERM",
        },
        // Without signal handlers the default action ends the process; there is nothing to wait for.
        _ => std::future::pending().await,
    }
}
