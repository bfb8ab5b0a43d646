//! What to write in place of a value of the wrong form: `40deg` for a number, `<1, 2, 3>` or `{ x: 1, y: 2, z: 3 }` for a vector, a
//! list for a mapping. Where nothing certain can be said, nothing is.

use crate::css;
use crate::suggest::{brief, is_same};
use crate::tree::{Datum, Entry, Tree, shown};
use crate::value::LinearRgb;

/// For a number.
pub fn number(tree: &Tree) -> Option<String> {
    match &tree.value {
        Datum::String(text) => {
            let text = text.trim();
            let end = text
                .find(|c: char| !(c.is_ascii_digit() || matches!(c, '.' | '-' | '+')))
                .unwrap_or(text.len());
            let (digits, unit) = text.split_at(end);
            if let Some((whole, part)) = text.split_once(',')
                && [whole, part].iter().all(|s| !s.is_empty() && s.bytes().all(|b| b.is_ascii_digit()))
            {
                return Some(format!("write `{whole}.{part}`, with a point"));
            }
            if let Some((a, b)) = text.split_once('/')
                && let (Ok(a), Ok(b)) = (a.trim().parse::<f64>(), b.trim().parse::<f64>())
                && b != 0.0
            {
                return Some(format!("write `{}`: nothing is calculated here", rounded(a / b)));
            }
            let v: f64 = digits.parse().ok()?;
            let unit = unit.trim();
            Some(match unit {
                "" => format!("write `{}`, without quotes", shown(v)),
                "%" => format!("write `{}`", rounded(v / 100.0)),
                "cm" => format!("write `{}`: lengths are in metres", rounded(v / 100.0)),
                "m" => format!("write `{}`: lengths are in metres", shown(v)),
                "rad" => format!("write `{}`: angles are in degrees", rounded(v.to_degrees())),
                _ => format!("write `{}`, the number alone", shown(v)),
            })
        }
        Datum::Sequence(items) => match items.as_slice() {
            [Tree { value: Datum::Number(v), .. }] => {
                Some(format!("write `{}`, without brackets", shown(*v)))
            }
            _ => None,
        },
        _ => None,
    }
}

/// For three numbers.
pub fn vector(tree: &Tree) -> Option<String> {
    let written = |v: [f64; 3]| format!("write `{}`", triple(v));
    match &tree.value {
        Datum::Mapping(_) => by_name(tree, ["x", "y", "z"]).map(written),
        Datum::String(text) => axis(text).or_else(|| three_of_text(text)).map(written),
        Datum::Sequence(items) => match items.as_slice() {
            [Tree { value: Datum::Sequence(inner), .. }] if inner.len() == 3 => {
                Some("one pair of brackets is enough".to_owned())
            }
            [a, b, c, Tree { value: Datum::Number(d), .. }] => {
                let [a, b, c] = numbers([a, b, c])?;
                Some(format!("leave out the fourth number, {}: {}", shown(*d), written([a, b, c])))
            }
            _ => None,
        },
        _ => None,
    }
}

/// For a colour.
pub fn colour(tree: &Tree) -> Option<String> {
    match &tree.value {
        Datum::Mapping(_) => by_name(tree, ["r", "g", "b"])
            .or_else(|| by_name(tree, ["red", "green", "blue"]))
            .map(|v| codes(v).unwrap_or_else(|| format!("write `{}`", triple(v)))),
        Datum::String(text) => colour_of_text(text),
        Datum::Sequence(_) => vector(tree),
        _ => None,
    }
}

/// For a colour that is told by a text.
fn colour_of_text(text: &str) -> Option<String> {
    let text = text.trim();
    if let Some(code) = css::code(text) {
        return Some(format!("colours have no names here: write '#{code:06x}'"));
    }
    let digits = text.trim_start_matches('#').trim_start_matches("0x");
    if digits.bytes().all(|b| b.is_ascii_hexdigit()) {
        return match digits.len() {
            6 => Some(format!("write '#{digits}'")),
            4 if text.starts_with('#') => Some(format!("a colour has no alpha: write '#{}'", &digits[..3])),
            8 => Some(format!("a colour has no alpha: write '#{}'", &digits[..6])),
            _ => None,
        };
    }
    let v = three_of_text(text)?;
    let bytes = text.starts_with("rgb(") || text.starts_with("rgba(");
    Some(codes(v).filter(|_| bytes).unwrap_or_else(|| format!("write `{}`", triple(v))))
}

/// For numbers of a colour above the 1 that is allowed.
pub fn too_bright(values: &[f64], quote: &str) -> String {
    if let Some(digits) = quote.strip_prefix("0x")
        && digits.len() == 6
    {
        return format!("write '#{digits}'");
    }
    let of = match *values {
        [r, g, b] => [r, g, b],
        [v, ..] => [v; 3],
        [] => [0.0; 3],
    };
    let as_codes = codes(of).filter(|_| of.iter().any(|v| *v >= 2.0));
    let why = "nothing reflects more light than falls on it; light that is sent out is a shape's `emission`";
    as_codes.map_or(why.to_owned(), |fix| {
        format!("if these are codes from 0 to 255, {fix}; from 0 to 1 they are light")
    })
}

/// Whole numbers from 0 to 255 as `#rrggbb`.
fn codes(v: [f64; 3]) -> Option<String> {
    let is_code = |v: &f64| (0.0..=255.0).contains(v) && v.fract() == 0.0;
    let [r, g, b] = v.iter().all(is_code).then(|| v.map(|v| v as u8))?;
    (r > 1 || g > 1 || b > 1).then(|| format!("write '#{r:02x}{g:02x}{b:02x}'"))
}

/// For a truth.
pub fn truth(tree: &Tree) -> Option<String> {
    let word = match &tree.value {
        Datum::String(word) => word.to_ascii_lowercase(),
        Datum::Number(v) => shown(*v),
        _ => return None,
    };
    match word.as_str() {
        "yes" | "on" | "1" | "y" | "true" => Some("write `true`".to_owned()),
        "no" | "off" | "0" | "n" | "false" => Some("write `false`".to_owned()),
        _ => None,
    }
}

/// For a mapping with the keys `names`.
pub fn mapping(tree: &Tree, names: &[&str]) -> Option<String> {
    let Datum::Sequence(items) = &tree.value else { return None };
    let first = items.iter().find_map(first_entry)?;
    names.contains(&first.key.value.as_str()).then(|| without_dash(first))
}

/// For a mapping that is called `owner` and is told by a lone value: the key that this is most likely the value of.
pub fn main_key(tree: &Tree, owner: &str, value: &str) -> Option<String> {
    let key = match owner {
        "diffuse" | "mirror" => "reflectance",
        "dielectric" => "eta",
        "conductor" => "metal",
        "sphere" => "radius",
        "environment" => "radiance",
        "point" => "position",
        "directional" => "direction",
        "mesh" => "file",
        "bezier" => "builtin",
        "instance" => "of",
        "film" => "size",
        "sampler" => "spp",
        "path" => "max_depth",
        "color" => "space",
        "lens" => return Some(format!("a lens in millimetres is the camera's `focal_length: {value}`")),
        _ => return None,
    };
    let colour = match &tree.value {
        Datum::String(name) => css::code(name),
        _ => None,
    };
    let is_number = ["size", "spp", "max_depth", "radius", "position", "direction"].contains(&key);
    if is_number && matches!(tree.value, Datum::String(_)) {
        return None;
    }
    match colour {
        Some(code) if matches!(key, "reflectance" | "radiance") => {
            Some(format!("write `{owner}: {{ {key}: '#{code:06x}' }}`"))
        }
        _ if value.is_empty() => None,
        _ => Some(format!("write `{owner}: {{ {key}: {value} }}`")),
    }
}

/// For a list of `N` numbers that is told by a text, such as `640x360`.
pub fn several<const N: usize>(tree: &Tree) -> Option<String> {
    const LONGEST: usize = 100;
    let text = match &tree.value {
        Datum::String(text) if text.len() <= LONGEST => text,
        _ => return None,
    };
    let parts = text
        .trim_matches(['[', ']', '(', ')', '<', '>'])
        .split(['x', '×', '*', ',', ' ', ';'])
        .filter(|p| !p.is_empty());
    let all: Option<Vec<f64>> = parts.map(|p| p.parse().ok().filter(|v: &f64| v.is_finite())).collect();
    let told: Vec<String> = all.filter(|all| all.len() == N)?.into_iter().map(shown).collect();
    Some(format!("write `[{}]`", told.join(", ")))
}

/// For a mapping of names to things.
pub fn named(tree: &Tree) -> Option<String> {
    match &tree.value {
        Datum::Sequence(items) => {
            let first = items.first()?;
            let Datum::Mapping(entries) = &first.value else {
                return Some(
                    "each has a name before it, such as `red: { diffuse: { reflectance: [0.8, 0.1, 0.1] } }`"
                        .to_owned(),
                );
            };
            let name = entries.iter().find(|e| ["name", "id"].iter().any(|w| is_same(w, &e.key.value)));
            if let Some(Entry { value: Tree { value: Datum::String(name), .. }, .. }) = name {
                return Some(format!("the name is the key: write `{}: ...`, without a `- `", brief(name)));
            }
            entries.first().map(without_dash)
        }
        Datum::String(name) => Some(format!("write `{}: ...`", brief(name))),
        _ => None,
    }
}

/// For a list of things.
pub fn list(tree: &Tree) -> Option<String> {
    let Datum::Mapping(entries) = &tree.value else { return None };
    let first = entries.first()?;
    // The first may be a name, under which is what would be an item.
    let inner =
        first_entry(&first.value).filter(|e| matches!(e.value.value, Datum::Mapping(_) | Datum::Null));
    Some(match inner {
        Some(kind) => {
            format!(
                "items have no names: in place of `{}:` write `- `, as in `- {}: ...`",
                brief(&first.key.value),
                brief(&kind.key.value)
            )
        }
        None => format!("each item begins with a `- `: write `- {}: ...`", brief(&first.key.value)),
    })
}

/// For one of several kinds.
pub fn choice(tree: &Tree, kinds: &[&str]) -> Option<String> {
    if let Datum::Sequence(items) = &tree.value
        && let [item] = items.as_slice()
    {
        return match &item.value {
            Datum::Mapping(_) => first_entry(item).map(without_dash),
            Datum::String(word) => Some(format!("write `{}`, without brackets or `- `", brief(word))),
            _ => None,
        };
    }
    colour_for_material(tree, kinds)
}

/// For a material that is told by a colour alone.
pub fn colour_for_material(tree: &Tree, kinds: &[&str]) -> Option<String> {
    if !kinds.contains(&"diffuse") {
        return None;
    }
    let colour = match &tree.value {
        Datum::Number(v) if (0.0..=1.0).contains(v) => shown(*v),
        Datum::String(s) if LinearRgb::from_hex(s).is_some() => format!("'{s}'"),
        Datum::String(s) => format!("'#{:06x}'", css::code(s)?),
        Datum::Sequence(items) => {
            let [a, b, c] = items.as_slice() else { return None };
            triple(numbers([a, b, c])?)
        }
        _ => return None,
    };
    Some(format!("write `diffuse: {{ reflectance: {colour} }}`"))
}

/// For a turn.
pub fn turn(tree: &Tree) -> Option<String> {
    let about = |axis: [f64; 3], degrees: f64| {
        format!("write `rotate: {{ axis: {}, degrees: {} }}`", triple(axis), shown(degrees))
    };
    let steps = |v: [f64; 3]| {
        let each = ["x", "y", "z"].iter().zip(v).filter(|(_, v)| *v != 0.0);
        let steps: Vec<String> =
            each.map(|(axis, v)| format!("rotate: {{ {axis}: {} }}", shown(v))).collect();
        match steps.as_slice() {
            [] => "leave it out: it turns nothing".to_owned(),
            [one] => format!("write `{one}`"),
            several => format!("turns have an order, so each is a step: `[{}]`", several.join(", ")),
        }
    };
    match &tree.value {
        Datum::Number(v) => Some(format!("about which axis? write `rotate: {{ y: {} }}`", shown(*v))),
        Datum::Sequence(items) => match items.as_slice() {
            [a, b, c] => numbers([a, b, c]).map(steps),
            // The angle comes first in pbrt and OpenGL.
            [Tree { value: Datum::Number(degrees), .. }, a, b, c] => {
                numbers([a, b, c]).map(|axis| about(axis, *degrees))
            }
            _ => None,
        },
        Datum::Mapping(_) => by_name(tree, ["x", "y", "z"]).map(steps),
        Datum::String(text) => three_of_text(text).map(steps),
        _ => None,
    }
}

/// Whether a value may be the first number of a list without brackets.
pub fn begins_list(tree: &Tree) -> bool {
    first_of_list(tree).is_some()
}

/// The first number of a list without brackets: `1`, `<1` or `rgb <1`.
pub fn first_of_list(tree: &Tree) -> Option<f64> {
    match &tree.value {
        Datum::Number(v) => Some(*v),
        Datum::String(text) => text.split(['<', '(']).next_back()?.trim().parse().ok(),
        _ => None,
    }
}

/// A further number of such a list, which YAML takes for a key: `2` or `3>`. Of duplicates the first is left.
pub fn loose_number(key: &str) -> Option<f64> {
    key.trim_end_matches(['>', ')']).trim().parse().ok().filter(|v: &f64| v.is_finite())
}

fn without_dash(entry: &Entry) -> String {
    format!("write `{}: ...` without the `- ` or brackets around it", brief(&entry.key.value))
}

fn first_entry(tree: &Tree) -> Option<&Entry> {
    match &tree.value {
        Datum::Mapping(entries) => entries.first(),
        _ => None,
    }
}

fn numbers<const N: usize>(items: [&Tree; N]) -> Option<[f64; N]> {
    let all: Vec<f64> =
        items.iter().filter_map(|t| if let Datum::Number(v) = t.value { Some(v) } else { None }).collect();
    all.try_into().ok()
}

/// The numbers under three names, at least one of which is there; 0 for those that aren't.
fn by_name(tree: &Tree, names: [&str; 3]) -> Option<[f64; 3]> {
    let Datum::Mapping(entries) = &tree.value else { return None };
    let is_named = |e: &Entry| {
        names.iter().any(|n| is_same(n, &e.key.value)) && matches!(e.value.value, Datum::Number(_))
    };
    if entries.is_empty() || !entries.iter().all(is_named) {
        return None;
    }
    let of =
        |name: &str| entries.iter().find(|e| is_same(name, &e.key.value)).and_then(|e| numbers([&e.value]));
    Some(names.map(|name| of(name).map_or(0.0, |[v]| v)))
}

/// An axis by its letter.
fn axis(text: &str) -> Option<[f64; 3]> {
    let (size, letter) =
        text.strip_prefix('-').map_or((1.0, text.trim_start_matches('+')), |rest| (-1.0, rest));
    let at = ["x", "y", "z"].iter().position(|l| l.eq_ignore_ascii_case(letter))?;
    let mut v = [0.0; 3];
    v[at] = size;
    Some(v)
}

/// Three numbers in a text such as `1 2 3`, `<1, 2, 3>` or `vec3(1, 2, 3)`.
fn three_of_text(text: &str) -> Option<[f64; 3]> {
    const LONGEST: usize = 100;
    if text.len() > LONGEST {
        return None;
    }
    // A word such as `rgb` or `vec3` may come before a bracket.
    let start = text.find(['<', '(', '[', '{']).map_or(0, |i| i + 1);
    let word = text[..start].trim_end_matches(['<', '(', '[', '{']).trim();
    let is_word =
        word.chars().all(|c| c.is_ascii_alphanumeric()) && !word.starts_with(|c: char| c.is_ascii_digit());
    let body = text[start..].trim_end_matches(['>', ')', ']', '}', ' ']);
    let body = body.strip_prefix("rgb ").unwrap_or(body);
    let parts: Option<Vec<f64>> = body
        .split([' ', ',', ';'])
        .filter(|p| !p.is_empty())
        .map(|p| p.parse::<f64>().ok().filter(|v| v.is_finite()))
        .collect();
    parts?.try_into().ok().filter(|_| is_word)
}

fn triple([x, y, z]: [f64; 3]) -> String {
    format!("[{}, {}, {}]", shown(x), shown(y), shown(z))
}

/// Without the dust of a division.
fn rounded(v: f64) -> String {
    shown(format!("{v:.6}").parse().unwrap_or(v))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::span::{Span, Spanned};

    fn tree(value: Datum) -> Tree {
        Tree { value, span: Span::NONE }
    }

    fn text(s: &str) -> Tree {
        tree(Datum::String(s.to_owned()))
    }

    fn list_of(v: &[f64]) -> Tree {
        tree(Datum::Sequence(v.iter().map(|v| tree(Datum::Number(*v))).collect()))
    }

    fn map(entries: &[(&str, f64)]) -> Tree {
        let entry = |(key, v): &(&str, f64)| Entry {
            key: Spanned::new((*key).to_owned(), Span::NONE),
            value: tree(Datum::Number(*v)),
        };
        tree(Datum::Mapping(entries.iter().map(entry).collect()))
    }

    #[test]
    fn numbers_are_found_in_what_people_write() {
        for (written, fix) in [
            ("40deg", "write `40`, the number alone"),
            ("1.5", "write `1.5`, without quotes"),
            ("50%", "write `0.5`"),
            ("1,5", "write `1.5`, with a point"),
            ("1/3", "write `0.333333`: nothing is calculated here"),
            ("5 cm", "write `0.05`: lengths are in metres"),
        ] {
            assert_eq!(number(&text(written)).as_deref(), Some(fix));
        }
        assert_eq!(number(&text("wide")), None);
        assert_eq!(number(&list_of(&[2.0])).as_deref(), Some("write `2`, without brackets"));
    }

    #[test]
    fn vectors_are_found_in_what_people_write() {
        for t in [
            text("1 2 3"),
            text("1, 2, 3"),
            text("<1, 2, 3>"),
            text("vec3(1, 2, 3)"),
            map(&[("x", 1.0), ("Z", 3.0), ("y", 2.0)]),
        ] {
            assert_eq!(vector(&t).as_deref(), Some("write `[1, 2, 3]`"), "{t:?}");
        }
        assert_eq!(vector(&text("-z")).as_deref(), Some("write `[0, 0, -1]`"));
        assert_eq!(several::<2>(&text("640x360")).as_deref(), Some("write `[640, 360]`"));
        assert_eq!((several::<2>(&text("640")), several::<2>(&text("wide x high"))), (None, None));
        assert_eq!(vector(&text("up")), None);
        assert_eq!(vector(&map(&[("x", 1.0), ("q", 2.0)])), None);
        assert!(
            vector(&list_of(&[1.0, 2.0, 3.0, 1.0])).unwrap().starts_with("leave out the fourth number, 1")
        );
    }

    #[test]
    fn colours_are_found_in_what_people_write() {
        for (t, fix) in [
            (text("red"), "colours have no names here: write '#ff0000'"),
            (text("aa3322"), "write '#aa3322'"),
            (text("0xaa3322"), "write '#aa3322'"),
            (text("#aa3322ff"), "a colour has no alpha: write '#aa3322'"),
            (text("rgb(170, 51, 34)"), "write '#aa3322'"),
            (text("rgb <1, 0, 0.5>"), "write `[1, 0, 0.5]`"),
            (map(&[("r", 1.0), ("g", 0.5), ("b", 0.0)]), "write `[1, 0.5, 0]`"),
        ] {
            assert_eq!(colour(&t).as_deref(), Some(fix), "{t:?}");
        }
        assert_eq!(colour(&text("D66")), None);
        assert!(too_bright(&[170.0, 51.0, 34.0], "").contains("'#aa3322'"));
        assert_eq!(too_bright(&[11_154_210.0], "0xaa3322"), "write '#aa3322'");
        assert!(too_bright(&[1.2, 0.1, 0.1], "").contains("`emission`"));
    }

    #[test]
    fn turns_are_found_in_what_people_write() {
        for (t, fix) in [
            (list_of(&[0.0, 30.0, 0.0]), "write `rotate: { y: 30 }`"),
            (
                list_of(&[10.0, 30.0, 0.0]),
                "turns have an order, so each is a step: `[rotate: { x: 10 }, rotate: { y: 30 }]`",
            ),
            (list_of(&[30.0, 0.0, 1.0, 0.0]), "write `rotate: { axis: [0, 1, 0], degrees: 30 }`"),
            (tree(Datum::Number(30.0)), "about which axis? write `rotate: { y: 30 }`"),
        ] {
            assert_eq!(turn(&t).as_deref(), Some(fix), "{t:?}");
        }
    }
}
