//! Dialling a coordinator: in plain on this machine, or over TLS with the pass of a join token, and in words for
//! people why it failed. It decides neither whom to dial nor when to try again.

use crate::join::{KEY_SIZE, Token};
use rustls::CertificateError;
use rustls::pki_types::{Der, TrustAnchor};
use std::error::Error;
use std::io;
use std::time::Duration;
use tokio::io::{AsyncReadExt as _, AsyncWriteExt as _};
use tokio::net::TcpStream;
use tokio::time::timeout;
use tonic::codegen::http::Uri;
use tonic::metadata::{Ascii, MetadataValue};
use tonic::service::Interceptor;
use tonic::service::interceptor::InterceptedService;
use tonic::transport::{Channel, ClientTlsConfig, Endpoint};
use tonic::{Request, Status};

/// The common name of every coordinator's authority. Which one is meant, its key says.
pub const AUTHORITY_NAME: &str = "Hatchery authority";
/// The name that every coordinator's certificate is good for, under whatever address it is reached: an authority
/// signs for one coordinator alone.
pub const SERVER_NAME: &str = "coordinator.hatchery.internal";
/// The largest frame of either side, bytes: a third less work than with the default.
pub const FRAME_SIZE_MAX: u32 = 128 << 10;
/// For a port to answer the first words of HTTP/2.
const HELLO_TIMEOUT: Duration = Duration::from_secs(2);

/// A connection on which each call shows the pass, if there is one.
pub type Line = InterceptedService<Channel, Show>;

/// Where a coordinator is, how to know it, and what to show it.
#[derive(Debug, Clone)]
pub struct Address {
    endpoint: Endpoint,
    show: Show,
}

/// Shows a pass at each call.
#[derive(Debug, Clone)]
pub struct Show(Option<MetadataValue<Ascii>>); // marked sensitive, so that `Debug` hides it

/// Why a text is no address of a coordinator.
#[derive(Debug, thiserror::Error)]
pub enum AddressError {
    /// No such URL.
    #[error("coordinator `{url}` is not of the form http://host:port")]
    Url {
        /// As given.
        url: String,
    },
    /// TLS without an authority to trust.
    #[error("coordinator `{url}`: over TLS a join token is needed, which names the authority to trust")]
    Tls {
        /// As given.
        url: String,
    },
    /// A token where a URL belongs.
    #[error("that is a join token, not a URL: give it as --join-file, HATCHERY_JOIN or --join")]
    Token,
}

/// Why a coordinator was not reached.
#[derive(Debug, thiserror::Error)]
pub enum DialError {
    /// Somebody else answers.
    #[error(
        "whoever answers at {uri} is not the coordinator that this token was made for: its certificate is of \
         another authority; check the address, or ask for a new token"
    )]
    Stranger {
        /// Where.
        uri: Uri,
    },
    /// A coordinator without credentials answers, or no coordinator.
    #[error(
        "{uri} does not speak TLS: its coordinator runs without credentials, and takes \
         --coordinator http://HOST:PORT instead of a token"
    )]
    Plain {
        /// Where.
        uri: Uri,
    },
    /// A coordinator with credentials answers.
    #[error("{uri} speaks TLS: its coordinator wants a join token (--join-file, HATCHERY_JOIN or --join)")]
    Tls {
        /// Where.
        uri: Uri,
    },
    /// Nobody answers.
    #[error("no coordinator answers at {uri}")]
    Silent {
        /// Where.
        uri: Uri,
        /// The transport's word.
        #[source]
        source: tonic::transport::Error,
    },
}

impl Address {
    /// A coordinator without credentials.
    ///
    /// # Errors
    /// Anything but `http://host:port`.
    pub fn plain(url: &str) -> Result<Address, AddressError> {
        if url.starts_with("hatchery:") {
            return Err(AddressError::Token);
        }
        if url.starts_with("https:") {
            return Err(AddressError::Tls { url: url.to_owned() });
        }
        let endpoint = Endpoint::from_shared(url.to_owned()).ok().filter(|endpoint| {
            let uri = endpoint.uri();
            uri.scheme_str() == Some("http")
                && uri.host().is_some_and(|host| !host.is_empty())
                && uri.port_u16().is_some()
        });
        let endpoint = endpoint.ok_or_else(|| AddressError::Url { url: url.to_owned() })?;
        Ok(Address { endpoint: tuned(endpoint), show: Show(None) })
    }

    /// A coordinator behind TLS, and the pass to show it.
    pub fn of(token: &Token) -> Address {
        let tls = ClientTlsConfig::new().trust_anchor(anchor(&token.pass.authority)).domain_name(SERVER_NAME);
        let endpoint = Endpoint::from_shared(format!("https://{}", token.address))
            .and_then(|endpoint| endpoint.tls_config(tls))
            .expect("a token's address makes a URL, and the name of the server is one");
        let mut bearer = MetadataValue::try_from(format!("Bearer {}", token.pass))
            .expect("a pass is letters, digits and dashes");
        bearer.set_sensitive(true);
        Address { endpoint: tuned(endpoint), show: Show(Some(bearer)) }
    }

    /// The same coordinator, with nothing to show it: it answers about its health, and no more.
    pub fn without_pass(self) -> Address {
        Address { show: Show(None), ..self }
    }

    /// With other settings of the connection.
    pub fn with(self, set: impl FnOnce(Endpoint) -> Endpoint) -> Address {
        Address { endpoint: set(self.endpoint), ..self }
    }

    /// Where it is; no secret.
    pub fn uri(&self) -> &Uri {
        self.endpoint.uri()
    }

    /// Dials.
    ///
    /// # Errors
    /// See [`DialError`].
    pub async fn connect(&self) -> Result<Line, DialError> {
        if self.uri().scheme_str() == Some("http") && speaks_tls(self.uri()).await {
            return Err(DialError::Tls { uri: self.uri().clone() });
        }
        let channel = self.endpoint.connect().await.map_err(|source| self.explain(source))?;
        Ok(InterceptedService::new(channel, self.show.clone()))
    }

    /// Dials in another way than over TCP: for a network that is simulated.
    ///
    /// # Errors
    /// When nobody answers.
    pub async fn connect_through<D>(&self, dial: impl FnOnce(Endpoint) -> D) -> Result<Line, DialError>
    where
        D: Future<Output = Result<Channel, tonic::transport::Error>>,
    {
        let channel = dial(self.endpoint.clone()).await.map_err(|source| self.explain(source))?;
        Ok(InterceptedService::new(channel, self.show.clone()))
    }

    /// Gives a line that dials when it is first used, and again when it breaks.
    pub fn connect_lazy(&self) -> Line {
        InterceptedService::new(self.endpoint.connect_lazy(), self.show.clone())
    }

    fn explain(&self, source: tonic::transport::Error) -> DialError {
        let uri = self.uri().clone();
        match tls_error(&source) {
            Some(rustls::Error::InvalidCertificate(
                CertificateError::UnknownIssuer
                | CertificateError::BadSignature
                | CertificateError::NotValidForName
                | CertificateError::NotValidForNameContext { .. },
            )) => DialError::Stranger { uri },
            Some(rustls::Error::InvalidMessage(_)) => DialError::Plain { uri },
            _ => DialError::Silent { uri, source },
        }
    }
}

impl Show {
    /// Of a line that needs no pass.
    pub fn nothing() -> Show {
        Show(None)
    }
}

impl Interceptor for Show {
    fn call(&mut self, mut request: Request<()>) -> Result<Request<()>, Status> {
        if let Some(bearer) = &self.0 {
            request.metadata_mut().insert("authorization", bearer.clone());
        }
        Ok(request)
    }
}

/// Whether a port answers the first words of HTTP/2 with an alert of TLS. A channel would only break and dial again.
async fn speaks_tls(uri: &Uri) -> bool {
    const HELLO: &[u8] = b"PRI * HTTP/2.0\r\n\r\nSM\r\n\r\n\0\0\0\x04\0\0\0\0\0";
    const ALERT: u8 = 0x15;
    let (Some(host), Some(port)) = (uri.host(), uri.port_u16()) else { return false };
    let host = host.trim_start_matches('[').trim_end_matches(']');
    let first_byte = async {
        let mut stream = TcpStream::connect((host, port)).await?;
        stream.write_all(HELLO).await?;
        stream.read_u8().await
    };
    // Whatever goes wrong here is for the channel to find out.
    matches!(timeout(HELLO_TIMEOUT, first_byte).await, Ok(Ok(ALERT)))
}

fn tuned(endpoint: Endpoint) -> Endpoint {
    endpoint.tcp_nodelay(true).max_frame_size(FRAME_SIZE_MAX)
}

/// What rustls said, which an I/O error carries inside.
fn tls_error<'a>(error: &'a (dyn Error + 'static)) -> Option<&'a rustls::Error> {
    std::iter::once(error).chain(causes(error)).find_map(|cause| {
        let io = cause.downcast_ref::<io::Error>()?;
        io.get_ref()?.downcast_ref::<rustls::Error>()
    })
}

fn causes<'a>(error: &'a (dyn Error + 'static)) -> impl Iterator<Item = &'a (dyn Error + 'static)> {
    std::iter::successors(error.source(), |&cause| cause.source())
}

/// An authority as certificates are checked against it: its name and its key, in DER without the outer tag. The
/// key alone tells authorities apart, so a token need not hold a whole certificate.
fn anchor(key: &[u8; KEY_SIZE]) -> TrustAnchor<'static> {
    const COMMON_NAME: [u8; 5] = [0x06, 0x03, 0x55, 0x04, 0x03]; // OBJECT IDENTIFIER 2.5.4.3
    /// SEQUENCE { ecPublicKey, prime256v1 }, and the head of a BIT STRING of 66 bytes, the first being 0.
    const P256: [u8; 24] = [
        0x30, 0x13, 0x06, 0x07, 0x2a, 0x86, 0x48, 0xce, 0x3d, 0x02, 0x01, 0x06, 0x08, 0x2a, 0x86, 0x48, 0xce,
        0x3d, 0x03, 0x01, 0x07, 0x03, 0x42, 0x00,
    ];
    let name = wrapped(0x0c, AUTHORITY_NAME.as_bytes()); // UTF8String
    let attribute = wrapped(0x30, &[&COMMON_NAME[..], &name].concat());
    TrustAnchor {
        subject: Der::from(wrapped(0x31, &attribute)),
        subject_public_key_info: Der::from([&P256[..], key].concat()),
        name_constraints: None,
    }
}

/// A DER value of up to 127 bytes under its tag.
fn wrapped(tag: u8, value: &[u8]) -> Vec<u8> {
    let length = u8::try_from(value.len()).expect("what is wrapped here is short");
    [&[tag, length], value].concat()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_coordinator_without_credentials_is_a_plain_url_with_a_port() {
        assert_eq!(Address::plain("http://127.0.0.1:7171").unwrap().uri(), "http://127.0.0.1:7171/");
        for (url, why) in [
            ("", "form http://host:port"),
            ("127.0.0.1:7171", "form http://host:port"),
            ("http://host", "form http://host:port"),
            ("http://", "form http://host:port"),
            ("a b", "form http://host:port"),
            ("https://host:1", "a join token is needed"),
            ("hatchery://host:1#worker-AAAA", "HATCHERY_JOIN"),
        ] {
            let error = Address::plain(url).unwrap_err().to_string();
            assert!(error.contains(why) && !error.contains("AAAA"), "{error}");
        }
    }

    #[test]
    fn an_authority_is_known_by_its_key_alone() {
        let key = rcgen::KeyPair::generate().unwrap();
        let mut params = rcgen::CertificateParams::default();
        params.is_ca = rcgen::IsCa::Ca(rcgen::BasicConstraints::Unconstrained);
        params.distinguished_name = rcgen::DistinguishedName::new();
        params.distinguished_name.push(rcgen::DnType::CommonName, AUTHORITY_NAME);
        let certificate = params.self_signed(&key).unwrap();
        let mut roots = rustls::RootCertStore::empty();
        roots.add(certificate.der().clone()).unwrap();
        let ours = anchor(key.public_key_raw().try_into().expect("P-256 is the default"));
        assert_eq!(roots.roots, [ours]);
    }
}
