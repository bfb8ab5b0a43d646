//! Scenes that move, frame by frame.

use crate::common::Folder;

/// A lamp that goes from dark to bright, and a ball that grows.
const MOVING: &str = "\
animation: { frames: 3, fps: 12 }
camera: { perspective: { eye: [0, 0, 4], look_at: [0, 0, 0] } }
film: { size: [12, 8] }
sampler: { spp: 2 }
world:
  - sphere:
      radius: { keyframes: { 0: 0.5, 2: 1 } }
      emission: { keyframes: { 0: '#000', 2: '#fff' }, interpolation: smooth }
lights:
  - environment: { radiance: 0.1 }
";

#[test]
fn each_frame_is_a_picture_and_all_are_an_animation() {
    let folder = Folder::with_scene(MOVING);
    let run = folder.straal("render scene.yaml --frames 0..3 -o film.##.png -o film.apng -q --json");
    assert_eq!(run.code, Some(0), "{}", run.err);
    assert_eq!(run.json()["frames"].as_array().unwrap().len(), 3);
    assert_eq!(folder.names(), ["film.00.png", "film.01.png", "film.02.png", "film.apng", "scene.yaml"]);
    // A frame by itself is the same, and frame 0 is what is rendered without a word.
    let hash = |words: &str| folder.json(words)["film_hash"].as_str().unwrap().to_owned();
    let frames: Vec<String> =
        (0..3).map(|i| hash(&format!("render scene.yaml --frame {i} -o a.png -q"))).collect();
    assert!(frames[0] != frames[1] && frames[1] != frames[2]);
    for (i, frame) in frames.iter().enumerate() {
        assert_eq!(run.json()["frames"][i]["film_hash"].as_str(), Some(frame.as_str()));
    }
    assert_eq!(hash("render scene.yaml -o a.png -q"), frames[0]);
    // The animation has as many pictures.
    let apng = folder.read("film.apng");
    let has = |name: &[u8]| apng.windows(4).filter(|w| *w == name).count();
    assert_eq!((has(b"acTL"), has(b"fcTL")), (1, 3));

    let run = folder.straal("render scene.yaml --frames all -o film.##.png --resume");
    assert_eq!(run.code, Some(0), "{}", run.err);
    assert!(run.err.contains("frame 2 is there"), "{}", run.err);
}

#[test]
fn a_frame_can_be_written_as_a_scene() {
    let folder = Folder::with_scene(MOVING);
    let run = folder.straal("render scene.yaml --frame 1 -o a.png --write-scene still.yaml -q");
    assert_eq!(run.code, Some(0), "{}", run.err);
    let text = String::from_utf8(folder.read("still.yaml")).unwrap();
    assert!(text.contains("radius: 0.75") && !text.contains("keyframes"), "{text}");
    let hash = |words: &str| folder.json(words)["film_hash"].as_str().unwrap().to_owned();
    assert_eq!(hash("render still.yaml -o b.png -q"), hash("render scene.yaml --frame 1 -o a.png -q"));
}

#[test]
fn what_is_no_frame_is_told() {
    let folder = Folder::with_scene(MOVING);
    for (words, complaint) in [
        ("render scene.yaml -o a.apng", "a.apng is an animation, and one frame is rendered"),
        ("render scene.yaml --frames 7", "a single frame is `--frame 7`"),
        ("render scene.yaml --frame 1..4", "several frames are `--frames 1..4`"),
        ("render scene.yaml --frames 4..4", "the first must be less than the end"),
        ("render scene.yaml --frames 0..2 -o -", "frames can't go to standard output"),
    ] {
        let run = folder.straal(words);
        assert_eq!(run.code, Some(2), "{words}: {}", run.err);
        assert!(run.err.contains(complaint), "{words}: {}", run.err);
    }
}
