//! Destination of a recording: the value of `--rerun`.

use std::fmt;
use std::net::{Ipv4Addr, SocketAddr};
use std::path::PathBuf;
use std::str::FromStr;
use thiserror::Error;

/// Port that the viewer connects to by default.
const DEFAULT_PORT: u16 = 9876;

/// URL schemes of a viewer.
const SCHEMES: [&str; 3] = ["rerun://", "rerun+http://", "rerun+https://"];

/// Destination of a recording.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum Target {
    /// Viewers connect to this address: `serve`, `serve=PORT` or `serve=IP:PORT`. Default 127.0.0.1:9876; port 0 picks a free
    /// one.
    Serve(SocketAddr),
    /// A file: `save=FILE.rrd`.
    Save(PathBuf),
    /// A running viewer: `connect=rerun+http://HOST:PORT/proxy`.
    Connect(String),
}

/// Reasons why a value of `--rerun` is invalid.
#[derive(Clone, Debug, PartialEq, Eq, Error)]
pub enum TargetError {
    /// None of the three kinds.
    #[error("`{0}` is invalid; allowed: serve, serve=PORT, serve=IP:PORT, save=FILE.rrd, connect=rerun+http://HOST:PORT/proxy")]
    Kind(String),
    /// `serve=` without a valid port or address.
    #[error("`{0}` is neither a port (0 to 65535) nor an address such as 127.0.0.1:9876")]
    Address(String),
    /// `save` without a file.
    #[error("save needs a file: save=FILE.rrd")]
    NoFile,
    /// `connect=` without a viewer's URL.
    #[error("`{0}` is not the URL of a viewer, such as rerun+http://127.0.0.1:9876/proxy")]
    Url(String),
}

impl FromStr for Target {
    type Err = TargetError;

    fn from_str(text: &str) -> Result<Self, TargetError> {
        let (kind, value) = text.split_once('=').unwrap_or((text, ""));
        match kind {
            "serve" if value.is_empty() && !text.contains('=') => Ok(Self::Serve(local(DEFAULT_PORT))),
            "serve" => {
                let port = value.parse().map(local);
                port.or_else(|_| value.parse()).map(Self::Serve).map_err(|_| TargetError::Address(value.to_owned()))
            }
            "save" if value.is_empty() => Err(TargetError::NoFile),
            "save" => Ok(Self::Save(value.into())),
            "connect" => {
                let host = SCHEMES.iter().find_map(|scheme| value.strip_prefix(scheme)).and_then(|rest| rest.strip_suffix("/proxy"));
                match host {
                    Some(host) if !host.is_empty() => Ok(Self::Connect(value.to_owned())),
                    _ => Err(TargetError::Url(value.to_owned())),
                }
            }
            _ => Err(TargetError::Kind(text.to_owned())),
        }
    }
}

impl fmt::Display for Target {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Serve(addr) => write!(f, "serve={addr}"),
            Self::Save(path) => write!(f, "save={}", path.display()),
            Self::Connect(url) => write!(f, "connect={url}"),
        }
    }
}

fn local(port: u16) -> SocketAddr {
    (Ipv4Addr::LOCALHOST, port).into()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_kind_is_parsed() {
        let read = |text: &str| text.parse::<Target>().unwrap();
        assert_eq!(read("serve"), Target::Serve(local(9876)));
        assert_eq!(read("serve=0"), Target::Serve(local(0)));
        assert_eq!(read("serve=0.0.0.0:9000"), Target::Serve("0.0.0.0:9000".parse().unwrap()));
        assert_eq!(read("save=runs/a=b.rrd"), Target::Save("runs/a=b.rrd".into()));
        assert_eq!(read("connect=rerun+http://10.0.0.1:9876/proxy"), Target::Connect("rerun+http://10.0.0.1:9876/proxy".to_owned()));
    }

    #[test]
    fn a_displayed_target_parses_to_itself() {
        for text in ["serve=127.0.0.1:9876", "serve=[::1]:7", "save=a.rrd", "connect=rerun://h:1/proxy"] {
            assert_eq!(text.parse::<Target>().unwrap().to_string(), text);
        }
    }

    #[test]
    fn every_mistake_has_its_own_error() {
        let error = |text: &str| text.parse::<Target>().unwrap_err();
        assert_eq!(error("spawn"), TargetError::Kind("spawn".to_owned()));
        assert_eq!(error(""), TargetError::Kind(String::new()));
        for value in ["", "70000", "localhost:9876", "-1"] {
            assert_eq!(error(&format!("serve={value}")), TargetError::Address(value.to_owned()));
        }
        assert_eq!(error("save"), TargetError::NoFile);
        assert_eq!(error("save="), TargetError::NoFile);
        for value in ["", "127.0.0.1:9876", "http://h:1/proxy", "rerun+http://h:1", "rerun:///proxy"] {
            assert_eq!(error(&format!("connect={value}")), TargetError::Url(value.to_owned()));
        }
    }
}
