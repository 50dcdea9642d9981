//! The door: a layer before all services that lets a call in by the pass it shows, and ends its answer when the
//! pass is good no more. Which pass which call takes stands here, and nowhere else.

use super::keyring::{Admission, Denied, Keyring};
use http::{HeaderMap, Request, Response, header};
use http_body::{Frame, SizeHint};
use proto::join::{Kind, Pass, TokenError};
use std::pin::Pin;
use std::task::{Context, Poll};
use tonic::Status;
use tonic::body::Body;
use tower::{Layer, Service};

/// What a call takes.
#[derive(Debug, PartialEq, Eq)]
enum Needs {
    /// Anybody may ask: those who watch over services hold no tokens.
    Nothing,
    Pass(Kind),
}

/// What a call takes, by its path. One that nobody thought of takes a client's.
fn needs(path: &str) -> Needs {
    match path {
        "/hatchery.v1.Fleet/Attach" => Needs::Pass(Kind::Worker),
        _ if path.starts_with("/grpc.health.v1.Health/") => Needs::Nothing,
        _ => Needs::Pass(Kind::Client),
    }
}

/// The layer. Without a keyring it lets everybody in, on loopback alone.
#[derive(Debug, Clone)]
pub(crate) struct Guard(pub(crate) Option<Keyring>);

impl<S> Layer<S> for Guard {
    type Service = Guarded<S>;

    fn layer(&self, inner: S) -> Guarded<S> {
        Guarded { inner, keyring: self.0.clone() }
    }
}

/// A service behind the door.
#[derive(Debug, Clone)]
pub(crate) struct Guarded<S> {
    inner: S,
    keyring: Option<Keyring>,
}

impl<S, B> Service<Request<B>> for Guarded<S>
where
    S: Service<Request<B>, Response = Response<Body>>,
    S::Future: Send + 'static,
{
    type Response = Response<Body>;
    type Error = S::Error;
    type Future = Pin<Box<dyn Future<Output = Result<Response<Body>, S::Error>> + Send>>;

    fn poll_ready(&mut self, context: &mut Context<'_>) -> Poll<Result<(), S::Error>> {
        self.inner.poll_ready(context)
    }

    fn call(&mut self, mut request: Request<B>) -> Self::Future {
        let admitted = self.keyring.as_ref().map(|keyring| admit(keyring, &request)).transpose();
        match admitted.map(Option::flatten) {
            Ok(None) => Box::pin(self.inner.call(request)),
            Ok(Some(admission)) => {
                request.extensions_mut().insert(admission.clone());
                let response = self.inner.call(request);
                Box::pin(async move { Ok(response.await?.map(|body| Body::new(until(body, admission)))) })
            }
            Err(denied) => {
                tracing::debug!(path = request.uri().path(), "not let in: {denied}");
                Box::pin(async move { Ok(Status::from(denied).into_http()) })
            }
        }
    }
}

/// `None`: it takes no pass.
fn admit<B>(keyring: &Keyring, request: &Request<B>) -> Result<Option<Admission>, Denied> {
    let path = request.uri().path();
    let Needs::Pass(kind) = needs(path) else { return Ok(None) };
    let shown = request.headers().get(header::AUTHORIZATION).ok_or(Denied::Missing)?;
    let shown = shown.to_str().ok().and_then(|text| text.strip_prefix("Bearer "));
    let pass: Pass = shown.ok_or(TokenError::Form).and_then(str::parse).map_err(Denied::Malformed)?;
    keyring.admit(&pass, kind, path.trim_start_matches('/')).map(Some)
}

fn until(body: Body, admission: Admission) -> Until {
    Until { body: Some(body), ended: Box::pin(admission.ended()) }
}

/// An answer that ends with its caller's token.
struct Until {
    /// Dropped when it ends, which tells the service that nobody reads any more.
    body: Option<Body>,
    ended: Pin<Box<dyn Future<Output = Denied> + Send>>,
}

impl http_body::Body for Until {
    type Data = bytes::Bytes;
    type Error = Status;

    fn poll_frame(
        mut self: Pin<&mut Self>,
        context: &mut Context<'_>,
    ) -> Poll<Option<Result<Frame<bytes::Bytes>, Status>>> {
        if self.body.is_none() {
            return Poll::Ready(None);
        }
        // First, so that a stream which always has something to say ends as well.
        let Poll::Ready(denied) = self.ended.as_mut().poll(context) else {
            let body = self.body.as_mut().expect("looked at above");
            return Pin::new(body).poll_frame(context);
        };
        self.body = None;
        let mut trailers = HeaderMap::new();
        let added = Status::from(denied).add_header(&mut trailers);
        Poll::Ready(Some(added.map(|()| Frame::trailers(trailers))))
    }

    fn is_end_stream(&self) -> bool {
        self.body.as_ref().is_none_or(http_body::Body::is_end_stream)
    }

    fn size_hint(&self) -> SizeHint {
        self.body.as_ref().map_or_else(SizeHint::default, http_body::Body::size_hint)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn workers_attach_clients_do_the_rest_and_anybody_may_ask_for_health() {
        assert_eq!(needs("/hatchery.v1.Fleet/Attach"), Needs::Pass(Kind::Worker));
        assert_eq!(needs("/grpc.health.v1.Health/Check"), Needs::Nothing);
        for path in [
            "/hatchery.v1.Fleet/Workers",
            "/hatchery.v1.Experiments/Submit",
            "/hatchery.v1.Lineage/Query",
            "/hatchery.v1.Evaluation/Evaluate",
            "/grpc.reflection.v1.ServerReflection/ServerReflectionInfo",
            "/grpc.health.v1.HealthX/Check",
            "/",
        ] {
            assert_eq!(needs(path), Needs::Pass(Kind::Client), "{path}");
        }
    }
}
