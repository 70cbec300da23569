//! Self-signed certificates: contents, and conditions for replacement.

use super::acceptor::Tls;
use super::error::TlsError;
use crate::net::host_name::HostName;
use rcgen::{CertificateParams, DnType, ExtendedKeyUsagePurpose, IsCa, KeyPair, KeyUsagePurpose, SanType};
use std::net::IpAddr;
use std::time::Duration;
use time::OffsetDateTime;
use tokio_rustls::rustls::crypto::ring::default_provider;
use tokio_rustls::rustls::pki_types::{CertificateDer, PrivateKeyDer, PrivatePkcs8KeyDer, ServerName, UnixTime};
use webpki::{EndEntityCert, Error, KeyUsage};

/// Validity of a certificate (days). Apple's systems refuse certificates of more than 825 days.
const VALID_DAYS: i64 = 800;

/// A certificate is replaced this many days before it expires.
pub(super) const RENEWED_BEFORE_DAYS: i64 = 30;

/// Validity before the time of generation (days), for devices whose clock is behind.
const BACKDATED_DAYS: i64 = 1;

/// Names and addresses in a certificate.
#[derive(Debug)]
pub(super) struct Names {
    all: Vec<ServerName<'static>>,
    /// Those that a stored certificate must contain.
    required: Vec<ServerName<'static>>,
}

impl Names {
    /// All `names` and `addresses`, and the address of the listener. A stored certificate must contain the names, and the address of the listener or, if it
    /// listens on all, every IPv4 address. It need not contain every IPv6 address of a machine that has IPv4, because most of those change daily.
    pub(super) fn new(names: impl IntoIterator<Item = HostName>, addresses: &[IpAddr], listening: IpAddr) -> Self {
        let names = names.into_iter().map(|name| name.server_name());
        let specific = Some(listening).filter(|ip| !ip.is_unspecified());
        let has_ipv4 = addresses.iter().any(|ip| ip.is_ipv4() && !ip.is_loopback());
        let mut all = Self { all: Vec::new(), required: names.collect() };
        all.all.clone_from(&all.required);
        all.all.extend(addresses.iter().copied().map(ServerName::from));
        all.all.extend(specific.filter(|ip| !addresses.contains(ip)).map(ServerName::from));
        let is_required = |ip: &IpAddr| match specific {
            Some(specific) => *ip == specific || ip.is_loopback(),
            None => ip.is_ipv4() || ip.is_loopback() || !has_ipv4,
        };
        let required: Vec<_> = addresses.iter().copied().chain(specific).filter(is_required).map(ServerName::from).collect();
        all.required.extend(required);
        all
    }
}

/// A certificate with its key.
pub(super) struct SelfSigned {
    certificate: CertificateDer<'static>,
    key: PrivateKeyDer<'static>,
    /// Both in PEM format.
    pub(super) pem: String,
}

impl SelfSigned {
    pub(super) fn into_tls(self) -> Result<Tls, TlsError> {
        Tls::from_parts(vec![self.certificate], self.key).map_err(|error| TlsError::Generate(error.to_string()))
    }
}

/// Generates a certificate for a server, with a key of its own.
pub(super) fn generate(names: &Names, now: OffsetDateTime) -> Result<SelfSigned, TlsError> {
    let generated = || {
        let mut params = CertificateParams::default();
        params.not_before = now - time::Duration::days(BACKDATED_DAYS);
        params.not_after = params.not_before + time::Duration::days(VALID_DAYS);
        params.distinguished_name.push(DnType::CommonName, "Prairie, self-signed");
        params.subject_alt_names = names.all.iter().map(alternative_name).collect::<Result<_, _>>()?;
        params.is_ca = IsCa::ExplicitNoCa;
        params.key_usages = vec![KeyUsagePurpose::DigitalSignature];
        params.extended_key_usages = vec![ExtendedKeyUsagePurpose::ServerAuth];
        let key = KeyPair::generate()?;
        let certificate = params.self_signed(&key)?;
        Ok(SelfSigned {
            pem: certificate.pem() + &key.serialize_pem(),
            certificate: certificate.der().clone(),
            key: PrivatePkcs8KeyDer::from(key.serialize_der()).into(),
        })
    };
    generated().map_err(|error: rcgen::Error| TlsError::Generate(error.to_string()))
}

fn alternative_name(name: &ServerName<'_>) -> Result<SanType, rcgen::Error> {
    Ok(match name {
        ServerName::IpAddress(ip) => SanType::IpAddress((*ip).into()),
        name => SanType::DnsName(name.to_str().as_ref().try_into()?),
    })
}

/// Why a certificate must be replaced, as the end of a sentence that begins with the certificate.
pub(super) fn reason_to_replace(certificate: &CertificateDer<'_>, names: &Names, now: OffsetDateTime) -> Option<String> {
    let unusable = |error: Error| Some(format!("cannot be used: {error}"));
    let parsed = EndEntityCert::try_from(certificate).and_then(|server| Ok((server, webpki::anchor_from_trusted_cert(certificate)?)));
    let (server, anchor) = match parsed {
        Ok(parsed) => parsed,
        Err(error) => return unusable(error),
    };
    let (anchors, algorithms) = ([anchor], default_provider().signature_verification_algorithms.all);
    for time in [now, now + time::Duration::days(RENEWED_BEFORE_DAYS)] {
        match server.verify_for_usage(algorithms, &anchors, &[], unix_time(time), KeyUsage::server_auth(), None, None) {
            Ok(_) => {}
            Err(Error::CertExpired { not_after, .. }) => {
                let tense = if time == now { "expired" } else { "expires" };
                return Some(format!("{tense} on {}", date(not_after)));
            }
            Err(Error::CertNotValidYet { not_before, .. }) => return Some(format!("is valid only from {}", date(not_before))),
            Err(error) => return unusable(error),
        }
    }
    let missing = names.required.iter().find(|name| server.verify_is_valid_for_subject_name(name).is_err())?;
    Some(format!("does not name {}", missing.to_str()))
}

fn unix_time(time: OffsetDateTime) -> UnixTime {
    UnixTime::since_unix_epoch(Duration::from_secs(time.unix_timestamp().max(0).unsigned_abs()))
}

fn date(time: UnixTime) -> String {
    let seconds = i64::try_from(time.as_secs()).unwrap_or(i64::MAX);
    OffsetDateTime::from_unix_timestamp(seconds).map_or_else(|_| format!("second {seconds}"), |time| time.date().to_string())
}

#[cfg(test)]
mod tests {
    use super::*;
    use x509_parser::prelude::{FromDer as _, X509Certificate};

    const LISTENING: IpAddr = IpAddr::V4(std::net::Ipv4Addr::UNSPECIFIED);

    fn names(names: &[&str], addresses: &[&str], listening: IpAddr) -> Names {
        let addresses: Vec<_> = addresses.iter().map(|ip| ip.parse().unwrap()).collect();
        Names::new(names.iter().map(|name| name.parse().unwrap()), &addresses, listening)
    }

    fn now() -> OffsetDateTime {
        OffsetDateTime::from_unix_timestamp(1_800_000_000).unwrap()
    }

    #[test]
    fn certificates_are_those_of_a_server_for_at_most_825_days() {
        let names = names(&["localhost", "laptop.local"], &["127.0.0.1", "192.168.1.5", "2001:db8::5"], LISTENING);
        let (one, other) = (generate(&names, now()).unwrap(), generate(&names, now()).unwrap());
        assert_ne!(one.certificate, other.certificate);
        let (_, certificate) = X509Certificate::from_der(&one.certificate).unwrap();
        let validity = certificate.validity();
        assert!((validity.not_after.timestamp() - validity.not_before.timestamp()) / 86_400 <= 825);
        assert!((1_799_900_000..1_800_000_000).contains(&validity.not_before.timestamp()));
        assert!(!certificate.basic_constraints().unwrap().unwrap().value.ca);
        assert_eq!(certificate.key_usage().unwrap().unwrap().value.flags, 1, "digital signature");
        let usage = certificate.extended_key_usage().unwrap().unwrap().value;
        assert!(usage.server_auth && !usage.any && !usage.client_auth);
        let alternative = certificate.subject_alternative_name().unwrap().unwrap().value;
        assert_eq!(alternative.general_names.len(), 5, "{alternative:?}");
        assert_eq!(reason_to_replace(&one.certificate, &names, now()), None);
    }

    #[test]
    fn a_certificate_is_replaced_before_it_expires() {
        let names = names(&["localhost"], &[], LISTENING);
        let certificate = generate(&names, now()).unwrap().certificate;
        let reason = |days| reason_to_replace(&certificate, &names, now() + time::Duration::days(days));
        assert_eq!(reason(VALID_DAYS - BACKDATED_DAYS - RENEWED_BEFORE_DAYS - 1), None);
        assert_eq!(reason(VALID_DAYS - BACKDATED_DAYS - RENEWED_BEFORE_DAYS + 1).unwrap(), "expires on 2029-03-24");
        assert_eq!(reason(VALID_DAYS).unwrap(), "expired on 2029-03-24");
        assert_eq!(reason(-9).unwrap(), "is valid only from 2027-01-14");
    }

    #[test]
    fn a_certificate_is_replaced_when_it_lacks_a_name_or_address() {
        let stored = generate(&names(&["localhost"], &["127.0.0.1", "192.168.1.5", "2001:db8::5"], LISTENING), now()).unwrap().certificate;
        let reason = |names: &Names| reason_to_replace(&stored, names, now());
        let v6_alone = &["127.0.0.1", "2001:db8::6"];
        assert_eq!(reason(&names(&["localhost"], &["127.0.0.1"], LISTENING)), None, "an address may be gone");
        assert_eq!(reason(&names(&["localhost", "play.example"], &[], LISTENING)).unwrap(), "does not name play.example");
        assert_eq!(reason(&names(&[], &["192.168.1.6"], LISTENING)).unwrap(), "does not name 192.168.1.6");
        assert_eq!(reason(&names(&[], &["192.168.1.5", "2001:db8::6"], LISTENING)), None, "a new IPv6 address beside IPv4");
        assert_eq!(reason(&names(&[], v6_alone, LISTENING)).unwrap(), "does not name 2001:db8::6");
        assert_eq!(reason(&names(&[], &["192.168.1.6"], "192.168.1.5".parse().unwrap())), None, "the server does not listen there");
        assert_eq!(reason(&names(&[], v6_alone, "2001:db8::6".parse().unwrap())).unwrap(), "does not name 2001:db8::6");
        assert_eq!(reason(&names(&[], &[], "10.0.0.1".parse().unwrap())).unwrap(), "does not name 10.0.0.1");
    }
}
