//! Ctrl-C and other signals, as shells and schedulers send them.
#![cfg(unix)]

use crate::common::{BALL, Folder, Run};
use std::io::{BufRead, BufReader, Read};
use std::process::{Child, ChildStderr, Command, Stdio};

/// The command, brought to a line of standard error.
struct Running {
    child: Child,
    err: BufReader<ChildStderr>,
    said: String,
}

impl Running {
    fn start(folder: &Folder, words: &str) -> Self {
        Self::of(folder.command(words))
    }

    fn of(mut command: Command) -> Self {
        let mut child = command.spawn().unwrap();
        let err = BufReader::new(child.stderr.take().unwrap());
        Self { child, err, said: String::new() }
    }

    /// Reads on until a line holds `part`.
    fn until(mut self, part: &str) -> Self {
        loop {
            let mut line = String::new();
            assert!(self.err.read_line(&mut line).unwrap() > 0, "no `{part}` in {}", self.said);
            self.said += &line;
            if line.contains(part) {
                return self;
            }
        }
    }

    fn press_ctrl_c(self) -> Self {
        self.send("INT")
    }

    fn send(self, signal: &str) -> Self {
        let id = self.child.id().to_string();
        assert!(Command::new("kill").args([&format!("-{signal}"), &id]).status().unwrap().success());
        self
    }

    fn end(mut self) -> Run {
        self.err.read_to_string(&mut self.said).unwrap();
        let mut out = String::new();
        self.child.stdout.take().unwrap().read_to_string(&mut out).unwrap();
        Run { code: self.child.wait().unwrap().code(), out, err: self.said }
    }
}

#[test]
fn the_first_ends_with_the_picture_so_far() {
    let folder = Folder::with_scene(BALL);
    let run = Running::start(&folder, "render scene.yaml -o a.exr --spp 200000 --json")
        .until("rendering")
        .press_ctrl_c()
        .end();
    assert_eq!(run.code, Some(130), "{run:?}");
    assert_eq!(folder.names(), ["a.exr", "scene.yaml"]);
    let report = run.json();
    assert_eq!((report["interrupted"].as_bool(), report["complete"].as_bool()), (Some(true), Some(false)));
    let samples = report["samples"].as_u64().unwrap();
    assert!(samples >= 1 && run.err.contains(&format!("ended by Ctrl-C with {samples} sample")), "{run:?}");
    let whole = folder.json(&format!("render scene.yaml -o b.exr --spp {samples}"));
    assert_eq!(whole["film_hash"], report["film_hash"]);
}

#[test]
fn schedulers_get_the_picture_so_far_as_well() {
    for signal in ["TERM", "HUP", "XFSZ", "XCPU"] {
        let folder = Folder::with_scene(BALL);
        let run = Running::start(&folder, "render scene.yaml -o a.png --spp 200000 --json")
            .until("rendering")
            .send(signal)
            .end();
        assert_eq!(run.code, Some(130), "{run:?}");
        assert_eq!(folder.names(), ["a.png", "scene.yaml"]);
        let report = run.json();
        assert_eq!(report["signal"], format!("SIG{signal}"));
        assert_eq!(report["interrupted"], true);
        assert!(run.err.contains(&format!("SIG{signal}: ending after this pass")), "{run:?}");
    }
}

/// The command, begun by a shell that does something before.
fn after(folder: &Folder, first: &str, words: &str) -> Command {
    let mut sh = Command::new("sh");
    sh.args(["-c", &format!("{first}; exec \"$0\" {words}")]).arg(folder.command("").get_program());
    sh.current_dir(folder.path("")).stdin(Stdio::null()).stdout(Stdio::piped()).stderr(Stdio::piped());
    sh
}

#[test]
fn what_outgrows_the_limit_is_told_and_does_not_lose_the_others() {
    let folder = Folder::with_scene(BALL);
    // 64 blocks of 512 bytes: the EXR has more, the PNG less.
    let words = "render scene.yaml --size 96x96 --spp 3 -o a.exr -o a.png --json";
    let run: Run = after(&folder, "ulimit -f 64", words).output().unwrap().into();
    assert_eq!(run.code, Some(3), "{run:?}");
    assert_eq!(folder.names(), ["a.png", "scene.yaml"]);
    assert!(
        run.err.contains("can't write a.exr") && run.err.contains("written all the same: a.png"),
        "{run:?}"
    );
    assert_eq!(run.json()["exit_code"], 3);
}

#[cfg(target_os = "linux")]
#[test]
fn nohup_is_respected() {
    let folder = Folder::with_scene(BALL);
    let command = after(&folder, "trap '' HUP", "render scene.yaml -o a.png --spp 200000");
    let run = Running::of(command).until("rendering").send("HUP").send("TERM").end();
    assert!(!run.err.contains("SIGHUP") && run.err.contains("ended by SIGTERM"), "{run:?}");
}

#[test]
fn what_was_left_half_written_is_swept() {
    let folder = Folder::with_scene(BALL);
    folder.write(".straal-abc.part", "half a picture");
    assert_eq!(folder.straal("render scene.yaml -o a.png --spp 1").code, Some(0));
    assert_eq!(folder.names(), ["a.png", "scene.yaml"]);
}

#[test]
fn a_replicate_that_is_not_whole_is_better_than_nothing() {
    let folder = Folder::with_scene(BALL);
    let run = Running::start(&folder, "render scene.yaml -o a.exr --spp 200000 --replicates 2 --json")
        .until("rendering")
        .press_ctrl_c()
        .end();
    assert_eq!(run.code, Some(130), "{run:?}");
    let report = run.json();
    let samples = report["samples"].as_u64().unwrap();
    assert!(samples >= 1 && report["complete"].as_bool() == Some(false), "{run:?}");
    let metadata = folder.json("info a.exr")["metadata"].clone();
    assert_eq!(metadata["straal.samples"], samples.to_string());
}

/// Brute force against a teapot of 50,000 triangles: the first pass alone would take minutes.
const SLOW: &str = "\
camera: { perspective: { eye: [0, 2, 8], look_at: [0, 1, 0], fov: 40 } }
film: { size: [640, 480] }
world:
  - bezier: { builtin: teapot, resolution: 28 }
lights:
  - environment: { radiance: [1, 1, 1] }
";

#[test]
fn the_second_ends_at_once() {
    let folder = Folder::with_scene(SLOW);
    let run = Running::start(&folder, "render scene.yaml -o a.exr --accel brute --isa scalar")
        .until("rendering")
        .press_ctrl_c()
        .until("Ctrl-C again")
        .press_ctrl_c()
        .end();
    assert_eq!(run.code, Some(130), "{run:?}");
    assert_eq!(folder.names(), ["scene.yaml"]);
}

/// What there is of the pass is safe at once: who sent the signal may kill before the pass is over.
#[test]
fn schedulers_that_do_not_wait_lose_nothing() {
    let folder = Folder::with_scene(SLOW);
    let words = "render scene.yaml -o a.exr --checkpoint 10h --accel brute --isa scalar";
    let running = Running::start(&folder, words).until("rendering").send("TERM").until("a second signal");
    while !folder.path("a.exr.checkpoint").exists() {
        std::thread::sleep(std::time::Duration::from_millis(5));
    }
    let run = running.send("KILL").end();
    assert_eq!(run.code, None, "{run:?}");
    let told = folder.straal("info a.exr.checkpoint").out;
    assert!(told.contains("samples 0 0\n") && told.contains("midway yes\n"), "{told}");
}
