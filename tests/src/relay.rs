//! A bad network in a process: a relay between a worker and its coordinator that delays, cuts up, thins out and holds
//! up what goes through it, and on command stalls, falls silent one way, or resets. What it carries, it does not read.

use std::future::pending;
use std::io;
use std::net::SocketAddr;
use std::time::Duration;

use creatures::random::{Stream, stream};
use tokio::io::{AsyncRead, AsyncReadExt as _, AsyncWrite, AsyncWriteExt as _};
use tokio::net::{TcpListener, TcpStream};
use tokio::runtime::Runtime;
use tokio::sync::{mpsc, watch};
use tokio::time::{Instant, sleep_until};

/// Fragments under way in one direction; beyond that whoever sends waits.
const UNDERWAY_MAX: usize = 256;

/// What a line does to all that it carries. Drawn for each fragment with a key, by connection and direction.
#[derive(Debug, Clone, Copy)]
pub struct Weather {
    /// The key of the draws.
    pub seed: u64,
    /// A fragment takes at least and at most so long, ms.
    pub latency_ms: [f64; 2],
    /// The longest fragment, bytes.
    pub fragment_size_max: usize,
    /// Bytes a second, each way.
    pub bandwidth: f64,
    /// The share of fragments that stop the line, themselves and all behind them.
    pub stall_share: f64,
    /// For how long, ms.
    pub stall_ms: f64,
}

impl Weather {
    /// A good day: nothing that a worker would notice.
    pub const FAIR: Weather = Weather {
        seed: 1,
        latency_ms: [0.0, 0.0],
        fragment_size_max: 1 << 16,
        bandwidth: 1e9,
        stall_share: 0.0,
        stall_ms: 0.0,
    };
}

/// One way through the relay.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Way {
    /// From the worker to the coordinator.
    Up,
    /// From the coordinator to the worker.
    Down,
}

/// What was commanded. Connections are numbered from 0: those below a number are meant.
#[derive(Debug, Clone, Copy, Default)]
struct Trouble {
    stalled: bool,
    dead_up: u32,
    dead_down: u32,
    reset: u32,
}

/// A relay at work, with a thread of its own. Everything that goes through it ends when it is dropped.
#[derive(Debug)]
pub struct Relay {
    address: SocketAddr,
    trouble: watch::Sender<Trouble>,
    connections: watch::Receiver<u32>,
    _runtime: Runtime,
}

impl Relay {
    /// Listens on a free port for those who mean a coordinator.
    ///
    /// # Panics
    /// When the system gives no thread or no port.
    pub fn new(coordinator: SocketAddr, weather: Weather) -> Relay {
        let runtime = tokio::runtime::Builder::new_multi_thread().worker_threads(1).enable_all().build();
        let runtime = runtime.expect("a runtime starts");
        let listener = runtime.block_on(TcpListener::bind("127.0.0.1:0")).expect("a port is free");
        let address = listener.local_addr().expect("a listener has an address");
        let (trouble, troubles) = watch::channel(Trouble::default());
        let (count, connections) = watch::channel(0);
        runtime.spawn(async move {
            while let Ok((near, _)) = listener.accept().await {
                let number = *count.borrow();
                let line = Line { number, weather, trouble: troubles.clone() };
                // A line that breaks is what both ends have to live with.
                tokio::spawn(async move { line.join(near, coordinator).await });
                count.send_replace(number + 1);
            }
        });
        Relay { address, trouble, connections, _runtime: runtime }
    }

    /// What a worker dials instead of its coordinator.
    pub fn address(&self) -> SocketAddr {
        self.address
    }

    /// How many connections were made through it so far.
    pub fn connections(&self) -> u32 {
        *self.connections.borrow()
    }

    /// Nothing goes through any more, either way. Connections stay open, and new ones are taken.
    pub fn stall(&self) {
        self.trouble.send_modify(|trouble| trouble.stalled = true);
    }

    /// What was held up by a stall goes on its way.
    pub fn mend(&self) {
        self.trouble.send_modify(|trouble| trouble.stalled = false);
    }

    /// The connections that there are lose all that goes one way, for ever, and nobody is told. New ones are sound.
    pub fn silence(&self, way: Way) {
        let number = self.connections();
        self.trouble.send_modify(|trouble| match way {
            Way::Up => trouble.dead_up = number,
            Way::Down => trouble.dead_down = number,
        });
    }

    /// The connections that there are end at once at both ends, with all that is under way.
    pub fn reset(&self) {
        let number = self.connections();
        self.trouble.send_modify(|trouble| trouble.reset = number);
    }
}

/// One connection through the relay.
struct Line {
    number: u32,
    weather: Weather,
    trouble: watch::Receiver<Trouble>,
}

impl Line {
    /// Carries both ways until both have ended, or one breaks.
    async fn join(&self, mut near: TcpStream, coordinator: SocketAddr) -> io::Result<()> {
        let mut far = TcpStream::connect(coordinator).await?;
        near.set_nodelay(true)?;
        far.set_nodelay(true)?;
        let both = async {
            let (near_reader, near_writer) = near.split();
            let (far_reader, far_writer) = far.split();
            let up = self.carry(Way::Up, near_reader, far_writer);
            let down = self.carry(Way::Down, far_reader, near_writer);
            tokio::try_join!(up, down)
        };
        tokio::select! {
            carried = both => return carried.map(drop),
            () = self.until(|trouble| self.number < trouble.reset) => {}
        }
        // Closed like this, a socket says that it was reset.
        near.set_zero_linger()?;
        far.set_zero_linger()
    }

    /// Carries one way until its end.
    async fn carry(
        &self,
        way: Way,
        reader: impl AsyncRead + Unpin,
        writer: impl AsyncWrite + Unpin,
    ) -> io::Result<()> {
        let (sender, receiver) = mpsc::channel(UNDERWAY_MAX);
        tokio::try_join!(self.cut_up(way, reader, sender), self.deliver(way, receiver, writer)).map(drop)
    }

    /// Takes in fragments, and says when each arrives.
    async fn cut_up(
        &self,
        way: Way,
        mut reader: impl AsyncRead + Unpin,
        sender: mpsc::Sender<(Instant, Vec<u8>)>,
    ) -> io::Result<()> {
        let weather = self.weather;
        let mut draws: Stream = stream(weather.seed, [self.number, way as u32, 0], "relay");
        let (mut sent, mut arrived) = (Instant::now(), Instant::now());
        loop {
            let mut fragment = vec![0; draws.within(1, weather.fragment_size_max)];
            let size = reader.read(&mut fragment).await?;
            if size == 0 {
                return Ok(());
            }
            fragment.truncate(size);
            sent = sent.max(Instant::now()) + Duration::from_secs_f64(size as f64 / weather.bandwidth);
            let mut takes_ms = draws.between(weather.latency_ms[0], weather.latency_ms[1]);
            if draws.chance(weather.stall_share) {
                takes_ms += weather.stall_ms;
            }
            // None overtakes another.
            arrived = arrived.max(sent + Duration::from_secs_f64(takes_ms / 1e3));
            if sender.send((arrived, fragment)).await.is_err() {
                return Ok(()); // the other half has said why
            }
        }
    }

    /// Hands over fragments at their time, and the end after the last of them.
    async fn deliver(
        &self,
        way: Way,
        mut receiver: mpsc::Receiver<(Instant, Vec<u8>)>,
        mut writer: impl AsyncWrite + Unpin,
    ) -> io::Result<()> {
        loop {
            let next = receiver.recv().await;
            if let Some((arrives, _)) = &next {
                sleep_until(*arrives).await;
            }
            self.until(|trouble| !trouble.stalled).await;
            if self.is_dead(way) {
                if next.is_none() {
                    return pending().await; // its end is lost as well
                }
                continue;
            }
            match next {
                Some((_, fragment)) => writer.write_all(&fragment).await?,
                None => return writer.shutdown().await,
            }
        }
    }

    fn is_dead(&self, way: Way) -> bool {
        let trouble = self.trouble.borrow();
        self.number < if way == Way::Up { trouble.dead_up } else { trouble.dead_down }
    }

    /// Waits for a command. Without a relay there is none any more.
    async fn until(&self, condition: impl FnMut(&Trouble) -> bool) {
        if self.trouble.clone().wait_for(condition).await.is_err() {
            pending::<()>().await;
        }
    }
}
