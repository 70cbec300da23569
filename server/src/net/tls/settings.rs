//! Settings of TLS, and the argument that chooses the source of the certificate.

use crate::net::host_name::HostName;
use std::path::PathBuf;
use std::str::FromStr;

/// Directory of Let's Encrypt, the default ACME service.
pub const LETS_ENCRYPT: &str = "https://acme-v02.api.letsencrypt.org/directory";

/// Source of the certificate.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum TlsChoice {
    /// A self-signed certificate, generated when none is stored or the stored one is unsuitable.
    SelfSigned,
    /// Two PEM files.
    Files {
        /// The certificate, followed by its chain.
        certificate: PathBuf,
        /// Its private key.
        key: PathBuf,
    },
    /// A certificate from an ACME service, such as Let's Encrypt.
    Acme {
        /// The domains that the certificate names; not empty.
        domains: Vec<HostName>,
    },
}

impl FromStr for TlsChoice {
    type Err = String;

    fn from_str(text: &str) -> Result<Self, String> {
        if let Some(domains) = text.strip_prefix("acme:") {
            let domains = domains.split(',').map(|domain| domain.parse().map_err(|error| format!("`{domain}`: {error}")));
            return Ok(Self::Acme { domains: domains.collect::<Result<_, _>>()? });
        }
        match text.split_once(',') {
            None if text == "self" => Ok(Self::SelfSigned),
            Some((certificate, key)) if !certificate.is_empty() && !key.is_empty() => {
                Ok(Self::Files { certificate: certificate.into(), key: key.into() })
            }
            _ => Err("expected `self`, two PEM files as `CERT,KEY`, or `acme:DOMAIN[,DOMAIN]`".to_owned()),
        }
    }
}

/// Settings of TLS.
#[derive(Clone, Debug)]
pub struct TlsSettings {
    /// Source of the certificate.
    pub choice: TlsChoice,
    /// Folder of the certificates that the server generates or obtains; `None` for the user's data folder.
    pub folder: Option<PathBuf>,
    /// Names that a self-signed certificate contains besides those of this machine.
    pub names: Vec<HostName>,
    /// The ACME service.
    pub acme: AcmeService,
}

impl TlsSettings {
    /// The default settings for a source of the certificate.
    pub fn new(choice: TlsChoice) -> Self {
        Self { choice, folder: None, names: Vec::new(), acme: AcmeService::default() }
    }
}

/// An ACME service (RFC 8555).
#[derive(Clone, Debug)]
pub struct AcmeService {
    /// Address of its directory. Default [`LETS_ENCRYPT`].
    pub directory: String,
    /// E-mail address to which the service may write; `None` for none.
    pub email: Option<String>,
    /// PEM file with the root certificate that vouches for the directory; `None` for those of the public services.
    pub root: Option<PathBuf>,
}

impl Default for AcmeService {
    fn default() -> Self {
        Self { directory: LETS_ENCRYPT.to_owned(), email: None, root: None }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn tls_choices_are_parsed() {
        assert_eq!("self".parse(), Ok(TlsChoice::SelfSigned));
        assert_eq!("a.pem,b.pem".parse(), Ok(TlsChoice::Files { certificate: "a.pem".into(), key: "b.pem".into() }));
        let domains = ["play.example", "www.play.example"].map(|name| name.parse().unwrap()).to_vec();
        assert_eq!("acme:play.example,WWW.play.example".parse(), Ok(TlsChoice::Acme { domains }));
        for wrong in ["", "auto", ",", "a.pem,", ",b.pem", "acme:", "acme:a.example,", "acme:192.168.1.5", "acme:*.example", "acme"] {
            assert!(wrong.parse::<TlsChoice>().is_err(), "{wrong}");
        }
    }
}
