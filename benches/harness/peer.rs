//! A peer: another program that runs in its own process and Python environment and does a piece of work on request. It
//! can be timed in turns with luxfer, without its start-up time.

use serde_json::Value;
use std::io::{BufRead, BufReader, Write};
use std::path::Path;
use std::process::{Child, ChildStdin, ChildStdout, Command, Stdio};

pub struct Peer {
    child: Child,
    input: ChildStdin,
    output: BufReader<ChildStdout>,
}

impl Peer {
    /// Starts `benches/peers/<script>` with the Python of `target/peers/<environment>`, and waits until it is ready.
    pub fn start(environment: &str, script: &str) -> Result<Self, String> {
        let root = Path::new(env!("CARGO_MANIFEST_DIR"));
        let python = root.join("target/peers").join(environment).join("bin/python");
        if !python.exists() {
            return Err(format!("{environment} is not installed; `make peers` installs it"));
        }
        let mut child = Command::new(python)
            .arg(root.join("benches/peers").join(script))
            .env("OMP_NUM_THREADS", "2")
            .stdin(Stdio::piped())
            .stdout(Stdio::piped())
            .spawn()
            .map_err(|e| e.to_string())?;
        let (Some(input), Some(output)) = (child.stdin.take(), child.stdout.take()) else {
            return Err("the peer has no pipes".into());
        };
        let mut peer = Self { child, input, output: BufReader::new(output) };
        // The peer writes one line when it is ready.
        peer.answer()?;
        Ok(peer)
    }

    /// Sends one line to the peer and waits for its answer, one line of JSON.
    pub fn ask(&mut self, question: &str) -> Result<Value, String> {
        writeln!(self.input, "{question}").map_err(|e| e.to_string())?;
        self.answer()
    }

    fn answer(&mut self) -> Result<Value, String> {
        let mut line = String::new();
        match self.output.read_line(&mut line) {
            Ok(0) => Err("the peer ended".into()),
            Ok(_) => serde_json::from_str(&line).map_err(|e| format!("{e} in {line}")),
            Err(e) => Err(e.to_string()),
        }
    }
}

impl Drop for Peer {
    fn drop(&mut self) {
        let _ = self.child.kill();
        let _ = self.child.wait();
    }
}
