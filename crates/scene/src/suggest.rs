//! "Did you mean": the nearest of the words that would have been right.

use std::borrow::Cow;

/// The candidate nearest to `word`, when it is near enough to be a slip of the hand.
pub fn nearest<'a>(word: &str, candidates: impl IntoIterator<Item = &'a str>) -> Option<&'a str> {
    const LONGEST: usize = 40;
    let typed: Vec<char> = fold(word).take(LONGEST + 1).collect();
    if typed.is_empty() || typed.len() > LONGEST {
        return None;
    }
    let mut best: Option<(usize, &str)> = None;
    for candidate in candidates {
        let right: Vec<char> = fold(candidate).take(LONGEST + 1).collect();
        let longer = if typed.len() > right.len() { typed.len() } else { right.len() };
        let distance = distance(&typed, &right);
        // A third of the letters may be wrong: `raduis` is radius, `foo` is nothing.
        if 3 * distance <= longer.next_multiple_of(3)
            && distance < longer
            && best.is_none_or(|b| distance < b.0)
        {
            best = Some((distance, candidate));
        }
    }
    best.map(|b| b.1)
}

/// Whether two words differ in case, `-` and `_` only.
pub fn is_same(a: &str, b: &str) -> bool {
    fold(a).eq(fold(b))
}

/// "did you mean `x`?" for the nearest candidate.
pub fn did_you_mean<'a>(word: &str, candidates: impl IntoIterator<Item = &'a str>) -> Option<String> {
    nearest(word, candidates).map(|c| format!("did you mean `{}`?", brief(c)))
}

/// Words as a message lists them.
pub fn list<'a>(words: impl IntoIterator<Item = &'a str>) -> String {
    words.into_iter().map(|w| format!("`{}`", brief(w))).collect::<Vec<_>>().join(", ")
}

/// A word of a file as a message shows it: cut where it is long, on one line.
pub fn brief(word: &str) -> Cow<'_, str> {
    const LONGEST: usize = 60;
    let cut = word.char_indices().nth(LONGEST).map(|(i, _)| i);
    if cut.is_none() && !word.contains(char::is_control) {
        return Cow::Borrowed(word);
    }
    let start = &word[..cut.unwrap_or(word.len())];
    let mut shown: String = start.chars().map(|c| if c.is_control() { ' ' } else { c }).collect();
    if cut.is_some() {
        shown += "...";
    }
    Cow::Owned(shown)
}

/// Case, `-` and `_` don't tell words apart.
pub(crate) fn fold(word: &str) -> impl Iterator<Item = char> {
    word.chars().filter(|c| !matches!(c, '_' | '-' | ' ')).flat_map(char::to_lowercase)
}

/// Insertions, deletions, replacements and swaps of neighbours that turn `a` into `b` (optimal string alignment).
fn distance(a: &[char], b: &[char]) -> usize {
    let width = b.len() + 1;
    let mut d = vec![0usize; (a.len() + 1) * width];
    for i in 0..=a.len() {
        for j in 0..=b.len() {
            d[i * width + j] = if i == 0 || j == 0 {
                i + j
            } else {
                let differ = usize::from(a[i - 1] != b[j - 1]);
                let swap = if i > 1 && j > 1 && a[i - 1] == b[j - 2] && a[i - 2] == b[j - 1] {
                    d[(i - 2) * width + j - 2] + 1
                } else {
                    usize::MAX
                };
                let change = d[(i - 1) * width + j - 1] + differ;
                let remove = d[(i - 1) * width + j] + 1;
                let insert = d[i * width + j - 1] + 1;
                [change, remove, insert, swap].into_iter().min().unwrap_or(0)
            };
        }
    }
    d[a.len() * width + b.len()]
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn slips_of_the_hand_are_found() {
        let keys = ["radius", "center", "material", "two_sided"];
        assert_eq!(nearest("raduis", keys), Some("radius"));
        assert_eq!(nearest("centre", keys), Some("center"));
        assert_eq!(nearest("Material", keys), Some("material"));
        assert_eq!(nearest("two-sided", keys), Some("two_sided"));
        assert_eq!(nearest("foo", keys), None);
        assert_eq!(nearest("", keys), None);
        assert_eq!(nearest(&"r".repeat(10_000), keys), None);
    }
}
