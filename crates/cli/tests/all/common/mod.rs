//! A folder that is swept away, and the command run in it.

// Each test file uses its own part of this.
#![allow(dead_code)]

use serde_json::Value as Json;
use std::path::PathBuf;
use std::process::{Command, Output, Stdio};
use tempfile::TempDir;

/// A ball on a floor under an even sky: 24 x 16 pixels, 4 samples.
pub const BALL: &str = "\
camera:
  perspective: { eye: [0, 1, 4], look_at: [0, 0.5, 0], fov: 40 }
film: { size: [24, 16] }
sampler: { spp: 4 }
world:
  - sphere: { center: [0, 0.5, 0], radius: 0.5 }
  - plane: {}
lights:
  - environment: { radiance: [1, 1, 1] }
";

/// A folder of its own for a test.
pub struct Folder {
    dir: TempDir,
}

/// What a run of the command left.
#[derive(Debug)]
pub struct Run {
    pub code: Option<i32>,
    pub out: String,
    pub err: String,
}

impl Folder {
    pub fn new() -> Self {
        Self { dir: tempfile::tempdir().unwrap() }
    }

    /// With `scene.yaml` in it.
    pub fn with_scene(text: &str) -> Self {
        let folder = Self::new();
        folder.write("scene.yaml", text);
        folder
    }

    pub fn path(&self, name: &str) -> PathBuf {
        self.dir.path().join(name)
    }

    pub fn write(&self, name: &str, text: &str) {
        std::fs::write(self.path(name), text).unwrap();
    }

    pub fn read(&self, name: &str) -> Vec<u8> {
        std::fs::read(self.path(name)).unwrap()
    }

    /// The names of all files, in order.
    pub fn names(&self) -> Vec<String> {
        let entries = std::fs::read_dir(self.dir.path()).unwrap();
        let mut names: Vec<_> =
            entries.map(|e| e.unwrap().file_name().to_string_lossy().into_owned()).collect();
        names.sort();
        names
    }

    /// The command, not yet run; words are parted by spaces.
    pub fn command(&self, words: &str) -> Command {
        let mut command = Command::new(env!("CARGO_BIN_EXE_straal"));
        command.args(words.split_whitespace()).current_dir(self.dir.path()).stdin(Stdio::null());
        command.env_remove("NO_COLOR").stdout(Stdio::piped()).stderr(Stdio::piped());
        command
    }

    pub fn straal(&self, words: &str) -> Run {
        self.command(words).output().unwrap().into()
    }

    /// Runs it with `--json`, which must work, and gives what it printed.
    pub fn json(&self, words: &str) -> Json {
        let run = self.straal(&format!("{words} --json"));
        assert_eq!(run.code, Some(0), "{words}: {run:?}");
        run.json()
    }
}

impl From<Output> for Run {
    fn from(o: Output) -> Self {
        let text = |bytes: Vec<u8>| String::from_utf8(bytes).unwrap();
        Self { code: o.status.code(), out: text(o.stdout), err: text(o.stderr) }
    }
}

impl Run {
    pub fn json(&self) -> Json {
        serde_json::from_str(&self.out).unwrap_or_else(|e| panic!("{e}: {self:?}"))
    }
}
