//! Ctrl-C and SIGTERM: the first asks for an orderly end, the second ends the process at once. It ends
//! nothing else.

use tokio::signal::unix::{SignalKind, signal};
use tokio::sync::watch;

use crate::exit::Exit;

/// Listens from its making on.
#[derive(Debug, Clone)]
pub(crate) struct Signals {
    asked: watch::Receiver<bool>,
}

impl Signals {
    /// Takes Ctrl-C and SIGTERM over from here on.
    pub(crate) fn listen() -> std::io::Result<Signals> {
        let (ask, asked) = watch::channel(false);
        let mut interrupt = signal(SignalKind::interrupt())?;
        let mut terminate = signal(SignalKind::terminate())?;
        tokio::spawn(async move {
            loop {
                tokio::select! {
                    _ = interrupt.recv() => {}
                    _ = terminate.recv() => {}
                }
                if ask.send_replace(true) {
                    std::process::exit(Exit::Interrupted as i32);
                }
            }
        });
        Ok(Signals { asked })
    }

    /// Completes when the process is first asked to end.
    pub(crate) async fn first(&mut self) {
        if self.asked.wait_for(|asked| *asked).await.is_err() {
            // The listener lives as long as the runtime; without it nobody can ask.
            std::future::pending::<()>().await;
        }
    }
}
