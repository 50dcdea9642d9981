//! Metrics: what this coordinator does, as Prometheus text on an address of its own. Off unless asked for. It
//! changes nothing and holds nothing up.

mod page;

use crate::driver::Driver;
use axum::Router;
use axum::extract::State;
use axum::http::header;
use axum::routing::get;
use page::Page;
use std::path::PathBuf;
use std::sync::Arc;
use tokio::net::TcpListener;

/// What a scrape is told it gets.
const CONTENT_TYPE: &str = "application/openmetrics-text; version=1.0.0; charset=utf-8";

/// Answers `GET /metrics` on a socket until the coordinator ends.
pub(crate) async fn serve(listener: TcpListener, driver: Driver, database: PathBuf) {
    let page = Arc::new(Page::new(driver, database));
    let answer =
        async |State(page): State<Arc<Page>>| ([(header::CONTENT_TYPE, CONTENT_TYPE)], page.text().await);
    let router = Router::new().route("/metrics", get(answer)).with_state(page);
    if let Err(error) = axum::serve(listener, router).await {
        tracing::error!(%error, "metrics are served no more");
    }
}
