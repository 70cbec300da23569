//! The file in which a self-signed certificate is kept, with its key, between starts.

use super::acceptor::Tls;
use super::error::TlsError;
use super::files::explain;
use super::self_signed::{self, Names};
use crate::escaped::escaped;
use crate::file;
use std::fs;
use std::io;
use std::path::{Path, PathBuf};
use time::OffsetDateTime;
use tokio_rustls::rustls::pki_types::pem::PemObject as _;
use tokio_rustls::rustls::pki_types::{CertificateDer, PrivateKeyDer};

/// Name of the file. One file for both keeps them consistent.
const FILE: &str = "self-signed.pem";

/// Largest size of the file (bytes).
const FILE_LIMIT: u64 = 1 << 20;

/// The certificate stored in `folder`; generates and stores one if there is none, or the stored one is damaged or must be replaced. The log says why. A
/// damaged file is kept under another name.
pub(super) fn open(folder: &Path, names: &Names, now: OffsetDateTime) -> Result<Tls, TlsError> {
    let path = folder.join(FILE);
    let failed = |file: &Path, reason: String| TlsError::Store { file: file.to_owned(), reason };
    fs::create_dir_all(folder).map_err(|error| failed(folder, format!("cannot be created: {error}")))?;
    if path.try_exists().map_err(|error| failed(&path, format!("cannot be read: {error}")))? {
        let stored = file::read(&path, FILE_LIMIT).map_err(|reason| failed(&path, format!("cannot be read: {reason}")))?;
        match parse(&stored) {
            Ok((tls, certificate)) => {
                let Some(reason) = self_signed::reason_to_replace(&certificate, names, now) else { return Ok(kept(tls, folder)) };
                tracing::info!("the stored certificate {reason}; generating another, so browsers will ask again");
            }
            Err(reason) => {
                let aside = set_aside(&path).map_err(|error| failed(&path, format!("{reason}, and cannot be renamed: {error}")))?;
                tracing::warn!(
                    "{} {reason}, and is now called {}; generating another certificate, so browsers will ask again",
                    escaped(&path),
                    escaped(&aside)
                );
            }
        }
    }
    let generated = self_signed::generate(names, now)?;
    file::write_atomically(&path, generated.pem.as_bytes()).map_err(|error| failed(&path, format!("cannot be written: {error}")))?;
    Ok(kept(generated.into_tls()?, folder))
}

fn kept(tls: Tls, folder: &Path) -> Tls {
    Tls { folder: Some(folder.to_owned()), ..tls }
}

/// Certificate and key of a file, or its fault.
fn parse(pem: &[u8]) -> Result<(Tls, CertificateDer<'static>), String> {
    let certificate = CertificateDer::from_pem_slice(pem).map_err(|error| explain("certificate", pem, &error))?;
    let key = PrivateKeyDer::from_pem_slice(pem).map_err(|error| explain("private key", pem, &error))?;
    let tls = Tls::from_parts(vec![certificate.clone()], key).map_err(|error| format!("cannot be used: {error}"))?;
    Ok((tls, certificate))
}

/// Renames a file to a free name beside it.
fn set_aside(path: &Path) -> io::Result<PathBuf> {
    let free = (1..).map(|number| path.with_extension(format!("damaged-{number}.pem"))).find(|path| !path.exists());
    let aside = free.expect("some number is free");
    fs::rename(path, &aside)?;
    Ok(aside)
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::net::{IpAddr, Ipv4Addr};

    const DAY: time::Duration = time::Duration::days(1);

    fn names(addresses: &[[u8; 4]]) -> Names {
        let addresses: Vec<_> = addresses.iter().map(|ip| IpAddr::from(*ip)).collect();
        Names::new(["localhost".parse().unwrap()], &addresses, Ipv4Addr::UNSPECIFIED.into())
    }

    fn fingerprint(folder: &Path, names: &Names, now: OffsetDateTime) -> String {
        let tls = open(folder, names, now).unwrap();
        assert_eq!(tls.folder(), Some(folder));
        tls.fingerprint().unwrap().to_owned()
    }

    fn files(folder: &Path) -> Vec<String> {
        let mut files: Vec<_> = fs::read_dir(folder).unwrap().map(|file| file.unwrap().file_name().into_string().unwrap()).collect();
        files.sort();
        files
    }

    #[test]
    fn a_certificate_is_kept_until_it_must_be_replaced() {
        let parent = tempfile::tempdir().unwrap();
        let folder = parent.path().join("new").join("folder");
        let now = OffsetDateTime::now_utc();
        let first = fingerprint(&folder, &names(&[[192, 168, 1, 5]]), now);
        assert_eq!(fingerprint(&folder, &names(&[[192, 168, 1, 5]]), now + 700 * DAY), first);
        let moved = fingerprint(&folder, &names(&[[192, 168, 1, 6]]), now);
        assert_ne!(moved, first, "another address");
        assert_eq!(fingerprint(&folder, &names(&[[192, 168, 1, 6]]), now), moved);
        assert_ne!(fingerprint(&folder, &names(&[[192, 168, 1, 6]]), now + 790 * DAY), moved, "almost expired");
        assert_eq!(files(&folder), [FILE], "nothing else is left behind");
    }

    #[cfg(unix)]
    #[test]
    fn only_the_user_may_read_the_key() {
        use std::os::unix::fs::PermissionsExt as _;
        let folder = tempfile::tempdir().unwrap();
        fingerprint(folder.path(), &names(&[]), OffsetDateTime::now_utc());
        assert_eq!(fs::metadata(folder.path().join(FILE)).unwrap().permissions().mode() & 0o777, 0o600);
    }

    #[test]
    fn a_damaged_file_is_replaced_and_kept_under_another_name() {
        let folder = tempfile::tempdir().unwrap();
        let (folder, now) = (folder.path(), OffsetDateTime::now_utc());
        let first = fingerprint(folder, &names(&[]), now);
        let path = folder.join(FILE);
        let sound = fs::read_to_string(&path).unwrap();
        let key_of_another = self_signed::generate(&names(&[]), now).unwrap().pem;
        let key_start = |pem: &str| pem.find("-----BEGIN PRIVATE KEY").unwrap();
        let mixed = sound[..key_start(&sound)].to_owned() + &key_of_another[key_start(&key_of_another)..];
        let cut = sound[..sound.len() / 2].to_owned();
        for (number, damaged) in [String::new(), cut, mixed, sound.replace('A', "!")].into_iter().enumerate() {
            fs::write(&path, &damaged).unwrap();
            let other = fingerprint(folder, &names(&[]), now);
            assert_ne!(other, first);
            assert_eq!(fingerprint(folder, &names(&[]), now), other, "the new one is kept");
            let aside = folder.join(format!("self-signed.damaged-{}.pem", number + 1));
            assert_eq!(fs::read_to_string(aside).unwrap(), damaged);
        }
        assert_eq!(files(folder).len(), 5);
    }

    #[test]
    fn a_file_that_cannot_be_used_is_named() {
        let folder = tempfile::tempdir().unwrap();
        let not_a_folder = folder.path().join("file");
        fs::write(&not_a_folder, "text").unwrap();
        fs::create_dir(folder.path().join(FILE)).unwrap();
        for (folder, named) in [(&not_a_folder, &not_a_folder), (&folder.path().to_owned(), &folder.path().join(FILE))] {
            let error = open(folder, &names(&[]), OffsetDateTime::now_utc()).unwrap_err().to_string();
            assert!(error.starts_with(&named.display().to_string()), "{error}");
        }
        assert_eq!(files(folder.path()), ["file", FILE]);
    }
}
