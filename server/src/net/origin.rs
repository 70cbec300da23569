//! Hosts and origins that requests may name, so that no page of another site can use this server through a visitor's browser.
//!
//! The check of `Origin` rejects WebSockets from other sites. The check of `Host` rejects sites whose name an attacker has pointed to this machine (DNS rebinding):
//! for the browser these are the same site as the attacker's page.

use super::addresses::own_names;
use super::host_name::{Authority, Host, HostName, Origin};
use super::tls::Tls;
use crate::log_limit::{LogLimit, excerpt};
use axum::http::{HeaderMap, HeaderValue, StatusCode, Version, header};

/// Status and text of a rejected request.
pub(super) type Rejection = (StatusCode, String);

/// Hosts and origins that requests may name.
#[derive(Debug)]
pub(crate) struct Access {
    origins: Vec<Origin>,
    names: Vec<HostName>,
    tls: Option<Tls>,
    rejected_hosts: LogLimit,
    rejected_origins: LogLimit,
}

impl Access {
    /// Allows the names of this machine, those in the certificate, `hosts`, and `origins` with their hosts. Addresses are always allowed.
    pub(crate) fn new(origins: &[Origin], hosts: &[HostName], tls: Option<Tls>) -> Self {
        let names = own_names().into_iter().chain(hosts.iter().cloned()).chain(origins.iter().filter_map(Origin::name).cloned());
        Self {
            origins: origins.to_vec(),
            names: names.collect(),
            tls,
            rejected_hosts: LogLimit::default(),
            rejected_origins: LogLimit::default(),
        }
    }

    /// Checks the `Host` header of a request. It must be there from HTTP/1.1 on; programs that speak HTTP/1.0 are not browsers.
    pub(super) fn check_host(&self, headers: &HeaderMap, version: Version) -> Result<(), Rejection> {
        let mut hosts = headers.get_all(header::HOST).iter();
        let host = match (hosts.next(), hosts.next()) {
            (Some(host), None) => host,
            (None, _) if version <= Version::HTTP_10 => return Ok(()),
            _ => return Err((StatusCode::BAD_REQUEST, "a request needs exactly one Host header\n".to_owned())),
        };
        let parsed = host.to_str().ok().and_then(Authority::parse);
        if parsed.as_ref().is_some_and(|at| self.is_own(&at.host)) {
            return Ok(());
        }
        let host = excerpt(host.as_bytes());
        if let Some(suppressed) = self.rejected_hosts.due() {
            tracing::warn!(host, suppressed, "rejected a request for another host; --allow-host NAME allows a name");
        }
        Err((
            StatusCode::MISDIRECTED_REQUEST,
            format!("`{host}` is not a name of this server; to allow it, start the server with --allow-host NAME\n"),
        ))
    }

    fn is_own(&self, host: &Host) -> bool {
        match host {
            Host::Ip(_) => true,
            Host::Name(name) => self.names.contains(name) || self.tls.as_ref().is_some_and(|tls| tls.names(name)),
        }
    }

    /// Checks that a request comes from a page of this server or of an allowed origin, or from a program other than a browser (without an origin).
    pub(super) fn check_origin(&self, headers: &HeaderMap) -> Result<(), Rejection> {
        let host = headers.get(header::HOST).and_then(|host| Authority::parse(host.to_str().ok()?));
        let is_allowed = |origin: &HeaderValue| {
            let origin = origin.to_str().ok().and_then(|origin| origin.parse::<Origin>().ok());
            origin.is_some_and(|origin| host.as_ref().is_some_and(|host| origin.is_at(host)) || self.origins.contains(&origin))
        };
        let Some(origin) = headers.get_all(header::ORIGIN).iter().find(|origin| !is_allowed(origin)) else { return Ok(()) };
        if let Some(suppressed) = self.rejected_origins.due() {
            let origin = excerpt(origin.as_bytes());
            tracing::warn!(origin, suppressed, "rejected a page of another origin; --allow-origin ORIGIN allows one");
        }
        let reason = "only pages of this server may ask for this; --allow-origin ORIGIN at its start allows others\n";
        Err((StatusCode::FORBIDDEN, reason.to_owned()))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use axum::http::HeaderName;
    use std::sync::{Arc, Mutex};

    fn headers(pairs: &[(HeaderName, &str)]) -> HeaderMap {
        pairs.iter().map(|(name, value)| (name.clone(), HeaderValue::from_bytes(value.as_bytes()).unwrap())).collect()
    }

    fn access(origins: &[&str], hosts: &[&str]) -> Access {
        let origins: Vec<_> = origins.iter().map(|origin| origin.parse().unwrap()).collect();
        let hosts: Vec<_> = hosts.iter().map(|host| host.parse().unwrap()).collect();
        Access::new(&origins, &hosts, None)
    }

    #[test]
    fn only_own_pages_and_programs_may_open_the_web_socket() {
        let access = access(&[], &[]);
        let host = (header::HOST, "prairie.example:8080");
        assert!(access.check_origin(&headers(std::slice::from_ref(&host))).is_ok());
        for (origin, allowed) in [
            ("http://prairie.example:8080", true),
            ("https://Prairie.example:8080", true),
            ("http://prairie.example", false),
            ("http://elsewhere.example:8080", false),
            ("null", false),
            ("", false),
            ("http://prairie.example:8080@elsewhere.example", false),
        ] {
            assert_eq!(access.check_origin(&headers(&[host.clone(), (header::ORIGIN, origin)])).is_ok(), allowed, "{origin}");
        }
        let default_port = [(header::HOST, "prairie.example"), (header::ORIGIN, "https://prairie.example:443")];
        assert!(access.check_origin(&headers(&default_port)).is_ok());
        let mut two = headers(&[host, (header::ORIGIN, "http://prairie.example:8080")]);
        two.append(header::ORIGIN, HeaderValue::from_static("http://elsewhere.example"));
        assert!(access.check_origin(&two).is_err());
    }

    #[test]
    fn origins_of_proxies_are_allowed_whatever_host_they_pass_on() {
        let access = access(&["https://play.example", "http://other.example:81"], &[]);
        for host in ["127.0.0.1:8080", "play.example", "play.example:8080"] {
            for (origin, allowed) in [
                ("https://play.example", true),
                ("https://play.example:443", true),
                ("http://other.example:81", true),
                ("https://play.example:8443", false),
                ("https://elsewhere.example", false),
            ] {
                let headers = headers(&[(header::HOST, host), (header::ORIGIN, origin)]);
                assert!(access.check_host(&headers, Version::HTTP_11).is_ok(), "{host}");
                assert_eq!(access.check_origin(&headers).is_ok(), allowed, "{origin} at {host}");
            }
        }
    }

    #[test]
    fn only_own_names_and_addresses_are_served() {
        let access = access(&[], &["Play.example"]);
        let own = hostname::get().unwrap().into_string().unwrap();
        for (host, allowed) in [
            ("127.0.0.1:8080", true),
            ("203.0.113.7", true),
            ("[::1]:8080", true),
            ("localhost:8080", true),
            ("LOCALHOST.", true),
            (own.as_str(), true),
            ("play.example:8443", true),
            ("elsewhere.example", false),
            ("127.0.0.1.elsewhere.example", false),
            ("localhost.elsewhere.example:8080", false),
            ("www.play.example", false),
            ("localhost:x", false),
            ("localhost@elsewhere.example", false),
            ("", false),
            ("\u{e9}", false),
        ] {
            let outcome = access.check_host(&headers(&[(header::HOST, host)]), Version::HTTP_11);
            assert_eq!(outcome.is_ok(), allowed, "{host}");
            assert!(outcome.is_ok() || outcome.is_err_and(|(status, text)| status == 421 && text.contains("--allow-host")), "{host}");
        }
        assert!(access.check_host(&HeaderMap::new(), Version::HTTP_10).is_ok());
        assert_eq!(access.check_host(&HeaderMap::new(), Version::HTTP_11).unwrap_err().0, 400);
        let mut two = headers(&[(header::HOST, "localhost")]);
        two.append(header::HOST, HeaderValue::from_static("elsewhere.example"));
        assert_eq!(access.check_host(&two, Version::HTTP_11).unwrap_err().0, 400);
    }

    #[derive(Clone, Default)]
    struct Log(Arc<Mutex<Vec<u8>>>);

    impl std::io::Write for Log {
        fn write(&mut self, bytes: &[u8]) -> std::io::Result<usize> {
            self.0.lock().unwrap().write(bytes)
        }

        fn flush(&mut self) -> std::io::Result<()> {
            Ok(())
        }
    }

    #[test]
    fn rejected_requests_cannot_fill_the_log() {
        let log = Log::default();
        let writer = log.clone();
        let subscriber = tracing_subscriber::fmt().with_writer(move || writer.clone()).with_ansi(false).finish();
        let long = "x\u{e9}".repeat(30_000);
        let headers = headers(&[(header::HOST, &long), (header::ORIGIN, &long)]);
        tracing::subscriber::with_default(subscriber, || {
            let access = access(&[], &[]);
            for _ in 0..1000 {
                let (_, text) = access.check_host(&headers, Version::HTTP_11).unwrap_err();
                assert!(text.len() < 500, "{} bytes in the answer", text.len());
                access.check_origin(&headers).unwrap_err();
            }
        });
        let log = String::from_utf8(log.0.lock().unwrap().clone()).unwrap();
        assert_eq!(log.lines().count(), 2, "one line each: {log}");
        assert!(log.len() < 1000 && log.contains("(90000 bytes)") && log.contains("\\xc3"), "{log}");
    }
}
