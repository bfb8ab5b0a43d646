//! The book's drawings, each by a function, most of them with straal's own code.

mod light;
mod rays;
mod search;

use crate::{Failure, root};

const FOLDER: &str = "book/src/images";

/// A file's name, without `.svg`, and what draws it.
type Diagram = (&'static str, fn() -> String);

/// Draws those that aren't as they should be.
pub fn run() -> Result<(), Failure> {
    for (name, drawn) in all() {
        let file = format!("{FOLDER}/{name}.svg");
        let (path, drawn) = (root().join(&file), drawn());
        if std::fs::read_to_string(&path).is_ok_and(|kept| kept == drawn) {
            continue;
        }
        std::fs::write(&path, drawn)?;
        println!("{file}");
    }
    Ok(())
}

fn all() -> impl Iterator<Item = Diagram> {
    rays::ALL.iter().chain(light::ALL).chain(search::ALL).copied()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn drawings_are_in_step_and_shown() {
        let folder = root().join("book/src");
        let pages: String = std::fs::read_dir(&folder)
            .unwrap()
            .map(|e| e.unwrap().path())
            .filter(|p| p.extension().is_some_and(|e| e == "md"))
            .map(|p| std::fs::read_to_string(p).unwrap())
            .collect();
        for (name, drawn) in all() {
            let kept = std::fs::read_to_string(folder.join(format!("images/{name}.svg"))).unwrap_or_default();
            assert!(kept == drawn(), "images/{name}.svg is out of date: run `cargo xtask book`");
            assert!(pages.contains(&format!("](images/{name}.svg)")), "{name} is on no page");
        }
    }
}
