//! Runs the program.

use std::process::{Command, Output};

/// A command that the environment of the test does not change.
pub(crate) fn command() -> Command {
    let mut command = Command::new(env!("CARGO_BIN_EXE_prairie"));
    command.env_remove("RUST_LOG").env_remove("NO_COLOR").env("PRAIRIE_WORLD", "none");
    command
}

pub(crate) fn prairie(arguments: &[&str]) -> Output {
    command().args(arguments).output().unwrap()
}

pub(crate) fn text(bytes: &[u8]) -> String {
    String::from_utf8_lossy(bytes).into_owned()
}

#[cfg(unix)]
pub(crate) use server::Server;

#[cfg(unix)]
mod server {
    use super::*;
    use std::io::{BufRead as _, BufReader, Read, Write as _};
    use std::net::TcpStream;
    use std::process::{Child, ChildStderr, ExitStatus, Stdio};
    use std::time::Duration;

    /// `prairie serve` on a free port.
    pub(crate) struct Server {
        pub(crate) child: Child,
        /// Host and port.
        pub(crate) address: String,
    }

    impl Server {
        /// Starts it, and reads its address from stdout. Nobody reads its stderr unless the test does.
        pub(crate) fn start(arguments: &[&str], environment: &[(&str, &str)]) -> Self {
            let mut command = command();
            command.args(["serve", "blades", "--addr", "127.0.0.1:0"]).args(arguments).envs(environment.iter().copied());
            let mut child = command.stdout(Stdio::piped()).stderr(Stdio::piped()).spawn().unwrap();
            let line = first_line(child.stdout.take().unwrap());
            let address = line.strip_prefix("Prairie is at http://").unwrap_or_else(|| panic!("{line}")).trim().to_owned();
            Self { child, address }
        }

        /// Response to a request, which may be nonsense; fails if there is none within 20 s.
        pub(crate) fn ask(&self, request: &str) -> String {
            let mut stream = TcpStream::connect(&self.address).unwrap();
            stream.set_read_timeout(Some(Duration::from_secs(20))).unwrap();
            stream.write_all(format!("{request}\r\nhost: {}\r\nconnection: close\r\n\r\n", self.address).as_bytes()).unwrap();
            let mut response = Vec::new();
            stream.read_to_end(&mut response).unwrap();
            text(&response)
        }

        pub(crate) fn stderr(&mut self) -> ChildStderr {
            self.child.stderr.take().unwrap()
        }

        /// Sends SIGTERM and waits for the end.
        pub(crate) fn stop(mut self) -> ExitStatus {
            assert!(Command::new("kill").arg(self.child.id().to_string()).status().unwrap().success());
            self.child.wait().unwrap()
        }
    }

    pub(crate) fn first_line(output: impl Read) -> String {
        let mut line = String::new();
        BufReader::new(output).read_line(&mut line).unwrap();
        line
    }
}
