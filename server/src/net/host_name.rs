//! Host names and origins, as arguments and in the headers of requests.

use axum::http::uri;
use std::fmt;
use std::net::IpAddr;
use std::str::FromStr;
use tokio_rustls::rustls::pki_types::ServerName;

/// A DNS name in lower case, such as `play.example`.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct HostName(String);

impl HostName {
    /// The name.
    pub fn as_str(&self) -> &str {
        &self.0
    }

    /// The name as TLS libraries take it.
    pub(super) fn server_name(&self) -> ServerName<'static> {
        ServerName::try_from(self.0.clone()).expect("checked when the name was parsed")
    }
}

impl fmt::Display for HostName {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(&self.0)
    }
}

impl FromStr for HostName {
    type Err = String;

    fn from_str(text: &str) -> Result<Self, String> {
        match Authority::parse(text) {
            Some(Authority { host: Host::Name(name), port: None }) => Ok(name),
            Some(Authority { host: Host::Ip(_), .. }) => Err("expected a name, such as `play.example`, not an address".to_owned()),
            Some(Authority { port: Some(_), .. }) => Err("expected a name without a port, such as `play.example`".to_owned()),
            None => Err("expected a name of letters, digits, hyphens and dots, such as `play.example`".to_owned()),
        }
    }
}

/// Origin of a page: scheme, host and port, such as `https://play.example` or `http://192.168.1.5:8080`.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Origin {
    is_https: bool,
    host: Host,
    port: u16,
}

impl Origin {
    /// The host, if it is a name.
    pub(super) fn name(&self) -> Option<&HostName> {
        match &self.host {
            Host::Name(name) => Some(name),
            Host::Ip(_) => None,
        }
    }

    /// Whether the host and port are those of a `Host` header.
    pub(super) fn is_at(&self, at: &Authority) -> bool {
        self.host == at.host && self.port == at.port.unwrap_or(default_port(self.is_https))
    }
}

impl FromStr for Origin {
    type Err = String;

    fn from_str(text: &str) -> Result<Self, String> {
        let parse = || {
            let (scheme, rest) = text.split_once("://")?;
            let is_https = match scheme.to_ascii_lowercase().as_str() {
                "https" => true,
                "http" => false,
                _ => return None,
            };
            let Authority { host, port } = Authority::parse(rest.strip_suffix('/').unwrap_or(rest))?;
            Some(Self { is_https, host, port: port.unwrap_or(default_port(is_https)) })
        };
        parse().ok_or_else(|| "expected scheme, host and port without a path, such as `https://play.example`".to_owned())
    }
}

const fn default_port(is_https: bool) -> u16 {
    if is_https { 443 } else { 80 }
}

#[derive(Clone, Debug, PartialEq, Eq)]
pub(super) enum Host {
    Name(HostName),
    Ip(IpAddr),
}

/// Host and port, as in a `Host` header.
#[derive(Debug)]
pub(super) struct Authority {
    pub(super) host: Host,
    pub(super) port: Option<u16>,
}

impl Authority {
    /// `HOST` or `HOST:PORT`, with brackets around IPv6 addresses; `None` for anything else.
    pub(super) fn parse(text: &str) -> Option<Self> {
        let authority: uri::Authority = text.parse().ok()?;
        let (host, port) = (authority.host(), authority.port_u16());
        // What is left is a user name, an empty port, or one out of range.
        if text.len() != host.len() + authority.port().map_or(0, |port| 1 + port.as_str().len())
            || authority.port().is_some() != port.is_some()
        {
            return None;
        }
        // `localhost.` is the same host as `localhost`.
        let name = host.strip_suffix('.').unwrap_or(host).to_ascii_lowercase();
        let host = match host.strip_prefix('[').and_then(|host| host.strip_suffix(']')) {
            Some(address) => Host::Ip(IpAddr::V6(address.parse().ok()?)),
            None => match ServerName::try_from(name.as_str()).ok()? {
                ServerName::IpAddress(ip) => Host::Ip(ip.into()),
                ServerName::DnsName(_) => Host::Name(HostName(name)),
                _ => return None,
            },
        };
        Some(Self { host, port })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn host_names_are_parsed() {
        for (text, name) in [("Play.Example", "play.example"), ("localhost.", "localhost"), ("my_host-2", "my_host-2")] {
            assert_eq!(text.parse::<HostName>().unwrap().as_str(), name);
        }
        for (wrong, reason) in [
            ("192.168.1.5", "not an address"),
            ("[::1]", "not an address"),
            ("play.example:8443", "without a port"),
            ("https://play.example", "letters"),
            ("play.example/", "letters"),
            ("*.example", "letters"),
            ("user@play.example", "letters"),
            ("", "letters"),
        ] {
            let error = wrong.parse::<HostName>().unwrap_err();
            assert!(error.contains(reason), "{wrong}: {error}");
        }
    }

    #[test]
    fn origins_are_parsed_with_their_default_ports() {
        let origin = |text: &str| text.parse::<Origin>().unwrap();
        assert_eq!(origin("https://Play.example"), origin("HTTPS://play.example:443/"));
        assert_ne!(origin("https://play.example"), origin("http://play.example"));
        assert_ne!(origin("https://play.example"), origin("https://play.example:8443"));
        assert_eq!(origin("http://[::1]:8080").port, 8080);
        for wrong in [
            "null",
            "play.example",
            "ftp://play.example",
            "https://play.example/path",
            "https://",
            "https://a:99999",
            "https://a@b",
            "https://a:",
        ] {
            assert!(wrong.parse::<Origin>().is_err(), "{wrong}");
        }
    }
}
