//! The small certification authority of one coordinator, and the certificate that it signs. It knows no token.

use super::folder::{AUTHORITY, AUTHORITY_KEY, Folder, FolderError, SERVER, SERVER_KEY};
use proto::dial::{AUTHORITY_NAME, SERVER_NAME};
use proto::join::KEY_SIZE;
use rcgen::{
    BasicConstraints, CertificateParams, DistinguishedName, DnType, ExtendedKeyUsagePurpose, IsCa, Issuer,
    KeyPair, KeyUsagePurpose,
};

/// Names of this machine for its own callers.
const OWN_NAMES: [&str; 3] = ["localhost", "127.0.0.1", "::1"];

/// An authority's public key, which tokens carry.
pub(super) type PublicKey = [u8; KEY_SIZE];

/// Makes an authority and the certificate of a server with these names and addresses.
///
/// # Errors
/// A name that no certificate can hold; a folder that cannot be written.
pub(super) fn found(folder: &Folder, hosts: &[String]) -> Result<PublicKey, FolderError> {
    let wrong = |error: rcgen::Error| folder.misread(AUTHORITY, error);
    let key = KeyPair::generate().map_err(wrong)?;
    let certificate = authority().self_signed(&key).map_err(wrong)?;
    let public = key.public_key_raw().try_into().expect("a key of P-256 has this size");
    folder.write(AUTHORITY_KEY, &key.serialize_pem())?;
    folder.write(AUTHORITY, &certificate.pem())?;
    certify(folder, hosts)?;
    Ok(public)
}

/// Makes a new key and certificate for the server under the authority that is there. Tokens stay good, since they
/// name the authority.
///
/// # Errors
/// A name that no certificate can hold; an authority whose key is not there.
pub(super) fn certify(folder: &Folder, hosts: &[String]) -> Result<(), FolderError> {
    let ca_key = KeyPair::from_pem(&folder.read(AUTHORITY_KEY)?);
    let ca_key = ca_key.map_err(|error| folder.misread(AUTHORITY_KEY, error))?;
    let issuer = Issuer::new(authority(), ca_key);
    let wrong = |error: rcgen::Error| folder.misread(SERVER, error);
    let names = hosts.iter().map(String::as_str).chain(OWN_NAMES).chain([SERVER_NAME]);
    let mut params = CertificateParams::new(names.map(str::to_owned).collect::<Vec<_>>()).map_err(wrong)?;
    // Another common name than the authority's: stock clients refuse a chain of equal ones.
    params.distinguished_name = named("Hatchery coordinator");
    params.key_usages = vec![KeyUsagePurpose::DigitalSignature];
    params.extended_key_usages = vec![ExtendedKeyUsagePurpose::ServerAuth];
    params.use_authority_key_identifier_extension = true;
    let key = KeyPair::generate().map_err(wrong)?;
    let certificate = params.signed_by(&key, &issuer).map_err(wrong)?;
    folder.write(SERVER_KEY, &key.serialize_pem())?;
    folder.write(SERVER, &certificate.pem())
}

/// Without an end: a machine whose clock is wrong must still get in, and what ends trust is a new folder.
fn authority() -> CertificateParams {
    let mut params = CertificateParams::default();
    params.distinguished_name = named(AUTHORITY_NAME);
    params.is_ca = IsCa::Ca(BasicConstraints::Constrained(0));
    params.key_usages = vec![KeyUsagePurpose::KeyCertSign, KeyUsagePurpose::CrlSign];
    params
}

fn named(common_name: &str) -> DistinguishedName {
    let mut name = DistinguishedName::new();
    name.push(DnType::CommonName, common_name);
    name
}
