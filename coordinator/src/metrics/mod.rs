//! Metrics: what this coordinator does, as Prometheus text on an address of its own. Off unless asked for. It
//! changes nothing and holds nothing up.

mod page;

use crate::driver::Driver;
use axum::Router;
use axum::extract::State;
use axum::http::header;
use axum::routing::get;
use hyper::server::conn::http1;
use hyper_util::rt::{TokioIo, TokioTimer};
use hyper_util::service::TowerToHyperService;
use page::Page;
use std::path::PathBuf;
use std::sync::Arc;
use std::time::Duration;
use tokio::net::TcpListener;
use tokio::sync::Semaphore;
use tokio::task::JoinSet;

/// What a scrape is told it gets.
const CONTENT_TYPE: &str = "application/openmetrics-text; version=1.0.0; charset=utf-8";

/// Whoever has not asked by then, or asks nothing more for so long, is hung up on.
const HEADER_TIMEOUT: Duration = Duration::from_secs(10);
/// Callers at once; others wait outside. A socket is a file, of which the workers need theirs.
const CALLERS_MAX: usize = 16;
/// After a call that could not be taken.
const PAUSE: Duration = Duration::from_millis(200);

/// Answers `GET /metrics` on a socket until the coordinator ends.
pub(crate) async fn serve(listener: TcpListener, driver: Driver, database: PathBuf) {
    let page = Arc::new(Page::new(driver, database));
    let answer =
        async |State(page): State<Arc<Page>>| ([(header::CONTENT_TYPE, CONTENT_TYPE)], page.text().await);
    let router = Router::new().route("/metrics", get(answer)).with_state(page);
    let (room, mut calls) = (Arc::new(Semaphore::new(CALLERS_MAX)), JoinSet::new());
    loop {
        let place = room.clone().acquire_owned().await.expect("nobody closes it");
        while calls.try_join_next().is_some() {}
        let stream = match listener.accept().await {
            Ok((stream, _)) => stream,
            Err(error) => {
                tracing::warn!(%error, "a call for metrics could not be taken");
                tokio::time::sleep(PAUSE).await;
                continue;
            }
        };
        let service = TowerToHyperService::new(router.clone());
        calls.spawn(async move {
            let mut http = http1::Builder::new();
            http.timer(TokioTimer::new()).header_read_timeout(HEADER_TIMEOUT);
            // What goes wrong with a caller is the caller's.
            let _ = http.serve_connection(TokioIo::new(stream), service).await;
            drop(place);
        });
    }
}
