//! Arguments of `prairie serve` about https and the names of the server.

use clap::{Args, ValueHint};
use prairie::net::{AcmeService, HostName, LETS_ENCRYPT, Origin, Tls, TlsChoice, TlsError, TlsSettings};
use std::net::SocketAddr;
use std::path::PathBuf;

/// Arguments about https and the names of the server.
#[derive(Debug, Args)]
pub(super) struct TlsArguments {
    /// Serve https: with a self-signed certificate (`self`), two PEM files, or a certificate from Let's Encrypt (`acme`)
    #[arg(long, env = "PRAIRIE_TLS", value_name = "self|CERT,KEY|acme:DOMAIN[,DOMAIN]")]
    tls: Option<TlsChoice>,
    /// Folder of the certificates of `--tls self` and `--tls acme` [default: prairie in your data folder]
    #[arg(long, env = "PRAIRIE_TLS_DIR", value_name = "DIR", value_hint = ValueHint::DirPath)]
    tls_dir: Option<PathBuf>,
    /// Your address for messages of the ACME service
    #[arg(long, env = "PRAIRIE_ACME_EMAIL", value_name = "ADDRESS", value_parser = email)]
    acme_email: Option<String>,
    /// Directory of the ACME service [default: that of Let's Encrypt]
    #[arg(long, env = "PRAIRIE_ACME_DIRECTORY", value_name = "URL", value_parser = directory)]
    acme_directory: Option<String>,
    /// PEM file with the root certificate of an ACME service of your own
    #[arg(long, env = "PRAIRIE_ACME_ROOT", value_name = "FILE", value_hint = ValueHint::FilePath)]
    acme_root: Option<PathBuf>,
    /// Name by which browsers reach this server, besides `localhost`, the host name and the names in the certificate; repeatable
    #[arg(long, env = "PRAIRIE_ALLOW_HOST", value_name = "NAME", value_delimiter = ',')]
    pub(super) allow_host: Vec<HostName>,
    /// Origin of pages that may connect, such as `https://play.example` behind a proxy; repeatable
    #[arg(long, env = "PRAIRIE_ALLOW_ORIGIN", value_name = "ORIGIN", value_delimiter = ',')]
    pub(super) allow_origin: Vec<Origin>,
}

impl TlsArguments {
    /// The first argument that needs another one, by its identifier, and the one that it needs.
    pub(super) fn unmet(&self) -> Option<(&'static str, &'static str)> {
        let is_acme = matches!(self.tls, Some(TlsChoice::Acme { .. }));
        let keeps_certificates = is_acme || self.tls == Some(TlsChoice::SelfSigned);
        let arguments = [
            ("tls_dir", self.tls_dir.is_some() && !keeps_certificates, "--tls self or --tls acme:DOMAIN"),
            ("acme_email", self.acme_email.is_some() && !is_acme, "--tls acme:DOMAIN"),
            ("acme_directory", self.acme_directory.is_some() && !is_acme, "--tls acme:DOMAIN"),
            ("acme_root", self.acme_root.is_some() && !is_acme, "--tls acme:DOMAIN"),
        ];
        arguments.into_iter().find(|(_, lacks_another, _)| *lacks_another).map(|(id, _, needed)| (id, needed))
    }

    /// Opens the certificate; `None` without `--tls`.
    ///
    /// # Errors
    /// When the certificate cannot be used.
    pub(super) fn open(&self, listening: SocketAddr) -> anyhow::Result<Option<Tls>> {
        let Some(choice) = &self.tls else { return Ok(None) };
        let settings = TlsSettings {
            folder: self.tls_dir.clone(),
            names: self.allow_host.clone(),
            acme: AcmeService {
                directory: self.acme_directory.clone().unwrap_or_else(|| LETS_ENCRYPT.to_owned()),
                email: self.acme_email.clone(),
                root: self.acme_root.clone(),
            },
            ..TlsSettings::new(choice.clone())
        };
        let tls = Tls::new(&settings, listening).map_err(|error| {
            let flag = if matches!(error, TlsError::Store { .. }) { "--tls-dir" } else { "--tls" };
            anyhow::Error::from(error).context(flag)
        })?;
        if matches!(choice, TlsChoice::Acme { .. }) && listening.port() != 443 {
            tracing::info!("the ACME service checks the domain at port 443, which must lead to port {}", listening.port());
        }
        Ok(Some(tls))
    }
}

fn email(text: &str) -> Result<String, String> {
    let is_address = text.split_once('@').is_some_and(|(user, host)| !user.is_empty() && host.parse::<HostName>().is_ok());
    if is_address && !text.contains(char::is_whitespace) {
        Ok(text.to_owned())
    } else {
        Err("expected an e-mail address, such as `me@play.example`".to_owned())
    }
}

fn directory(text: &str) -> Result<String, String> {
    let rest = text.strip_prefix("https://").or_else(|| text.strip_prefix("http://"));
    if rest.is_some_and(|rest| !rest.is_empty() && !rest.starts_with('/') && !text.contains(char::is_whitespace)) {
        Ok(text.to_owned())
    } else {
        Err(format!("expected the URL of a directory, such as `{LETS_ENCRYPT}`"))
    }
}
