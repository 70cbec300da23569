//! A certificate and its key from two PEM files.

use super::acceptor::Tls;
use super::error::TlsError;
use crate::escaped::escaped;
use crate::file;
use std::path::Path;
use tokio_rustls::rustls::pki_types::pem::{self, PemObject};
use tokio_rustls::rustls::pki_types::{CertificateDer, PrivateKeyDer};
use tokio_rustls::rustls::{self, InconsistentKeys};

/// Largest size of either file (bytes).
const FILE_LIMIT: u64 = 1 << 20;

/// First line of an encrypted key.
const ENCRYPTED: &[u8] = b"-----BEGIN ENCRYPTED PRIVATE KEY-----";

/// Reads a certificate with its chain, and its key; an error names the file at fault.
pub(super) fn read(certificate: &Path, key: &Path) -> Result<Tls, TlsError> {
    let fault = |file: &Path, reason: String| TlsError::File { file: file.to_owned(), reason };
    let contents = |file| file::read(file, FILE_LIMIT).map_err(|reason| fault(file, format!("cannot be read: {reason}")));
    let (first, second) = (contents(certificate)?, contents(key)?);
    if is_key(&first) && !is_certificate(&first) && is_certificate(&second) && !is_key(&second) {
        let [first, second] = [certificate, key].map(escaped);
        let reason = format!("contains the private key and {second} the certificate; the certificate comes first: --tls {second},{first}");
        return Err(fault(certificate, reason));
    }
    let chain = CertificateDer::pem_slice_iter(&first)
        .collect::<Result<Vec<_>, _>>()
        .and_then(|chain| if chain.is_empty() { Err(pem::Error::NoItemsFound) } else { Ok(chain) });
    let chain = chain.map_err(|error| fault(certificate, explain("certificate", &first, &error)))?;
    let private = PrivateKeyDer::from_pem_slice(&second).map_err(|error| fault(key, explain("private key", &second, &error)))?;
    rustls::crypto::ring::sign::any_supported_type(&private)
        .map_err(|error| fault(key, format!("contains a private key that cannot be used ({error}); allowed: ECDSA, Ed25519 and RSA")))?;
    let belongs_to = |nth: &CertificateDer<'static>| Tls::from_parts(vec![nth.clone()], private.clone_key()).is_ok();
    Tls::from_parts(chain.clone(), private.clone_key()).map_err(|error| match error {
        rustls::Error::InconsistentKeys(InconsistentKeys::KeyMismatch) => match chain.iter().position(belongs_to) {
            Some(at) => {
                fault(certificate, format!("must begin with the certificate of the key {}, which is number {} in it", escaped(key), at + 1))
            }
            None => fault(key, format!("contains another key than that of the certificate {}", escaped(certificate))),
        },
        error => fault(certificate, format!("cannot be used: {error}")),
    })
}

fn is_certificate(contents: &[u8]) -> bool {
    CertificateDer::from_pem_slice(contents).is_ok()
}

fn is_key(contents: &[u8]) -> bool {
    PrivateKeyDer::from_pem_slice(contents).is_ok()
}

/// Message about a PEM file without a valid `what`.
pub(super) fn explain(what: &str, contents: &[u8], error: &pem::Error) -> String {
    let is_encrypted = contents.windows(ENCRYPTED.len()).any(|window| window == ENCRYPTED);
    match error {
        pem::Error::NoItemsFound if is_encrypted => {
            "contains an encrypted private key; decrypt it with `openssl pkey -in ENCRYPTED -out KEY`".to_owned()
        }
        pem::Error::NoItemsFound if is_key(contents) => format!("contains a private key, but no {what}"),
        pem::Error::NoItemsFound if is_certificate(contents) => format!("contains a certificate, but no {what}"),
        pem::Error::NoItemsFound => format!("contains no {what} in PEM format (`-----BEGIN …`)"),
        pem::Error::MissingSectionEnd { .. } => format!("contains a {what} that is cut off"),
        damaged => format!("contains a damaged {what}: {damaged}"),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::fs;

    #[test]
    fn errors_name_the_file_at_fault() {
        let folder = tempfile::tempdir().unwrap();
        let path = |name: &str| folder.path().join(name);
        let write = |name: &str, text: &str| fs::write(path(name), text).unwrap();
        let generate = || rcgen::generate_simple_self_signed(vec!["localhost".to_owned()]).unwrap();
        let (one, other) = (generate(), generate());
        write("good.pem", &one.cert.pem());
        write("good.key", &one.signing_key.serialize_pem());
        write("both.pem", &(one.cert.pem() + &one.signing_key.serialize_pem()));
        write("chain.pem", &(one.cert.pem() + &other.cert.pem()));
        write("reversed.pem", &(other.cert.pem() + &one.cert.pem()));
        write("other.key", &other.signing_key.serialize_pem());
        write("text.pem", "no certificate");
        write("damaged.pem", "-----BEGIN CERTIFICATE-----\n!!!!\n-----END CERTIFICATE-----\n");
        write("cut.pem", &one.cert.pem()[..200]);
        write("empty.pem", "-----BEGIN CERTIFICATE-----\nAAAA\n-----END CERTIFICATE-----\n");
        write("empty.key", "-----BEGIN PRIVATE KEY-----\nAAAA\n-----END PRIVATE KEY-----\n");
        write("encrypted.key", "-----BEGIN ENCRYPTED PRIVATE KEY-----\nAAAA\n-----END ENCRYPTED PRIVATE KEY-----\n");
        for certificate in ["good.pem", "both.pem", "chain.pem"] {
            read(&path(certificate), &path("good.key")).unwrap();
        }
        read(&path("both.pem"), &path("both.pem")).unwrap();
        for (certificate, key, at_fault, reason) in [
            ("missing.pem", "good.key", "missing.pem", "cannot be read: "),
            ("good.pem", "missing.key", "missing.key", "cannot be read: "),
            ("text.pem", "good.key", "text.pem", "contains no certificate in PEM format"),
            ("good.pem", "text.pem", "text.pem", "contains no private key in PEM format"),
            ("damaged.pem", "good.key", "damaged.pem", "contains a damaged certificate"),
            ("cut.pem", "good.key", "cut.pem", "contains a certificate that is cut off"),
            ("empty.pem", "good.key", "empty.pem", "cannot be used: "),
            ("good.pem", "empty.key", "empty.key", "contains a private key that cannot be used"),
            ("good.pem", "encrypted.key", "encrypted.key", "contains an encrypted private key"),
            ("good.key", "other.key", "good.key", "contains a private key, but no certificate"),
            ("good.pem", "chain.pem", "chain.pem", "contains a certificate, but no private key"),
            ("good.pem", "other.key", "other.key", "contains another key than that of the certificate "),
            ("reversed.pem", "good.key", "reversed.pem", "must begin with the certificate of the key "),
        ] {
            let error = read(&path(certificate), &path(key)).unwrap_err().to_string();
            assert!(error.starts_with(&format!("{} {reason}", path(at_fault).display())), "{error}");
        }
        let swapped = read(&path("good.key"), &path("good.pem")).unwrap_err().to_string();
        assert!(swapped.contains(&format!("--tls {},{}", path("good.pem").display(), path("good.key").display())), "{swapped}");
    }
}
