//! Layers as text (.usda).

mod words;

use super::layer::{
    DEEPEST, Edit, Kind, LONGEST, Layer, Numbers, Offset, Property, Reference, Spec, Specifier, Value,
    absolute, join,
};

/// What is wrong with a text, and at which byte.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(super) struct Wrong {
    pub at: usize,
    pub problem: String,
}

type Result<T> = std::result::Result<T, Wrong>;

/// How a binding of a material says that those further in don't count.
pub(super) const STRONG: &str = "strongerThanDescendants";

/// Reads one.
pub(super) fn read(text: &str) -> Result<Layer> {
    let mut parser = Parser { text, at: 0, layer: Layer::default() };
    parser.layer.prims.insert("/".to_owned(), Spec::default());
    let header = text.lines().next().unwrap_or("");
    if !header.starts_with("#usda") {
        return Err(parser.wrong("a layer of USD begins with `#usda 1.0`"));
    }
    parser.at = header.len();
    if parser.peek() == Some(b'(') {
        parser.metadata("/")?;
    }
    while parser.peek().is_some() {
        let word = parser.word()?;
        match specifier(word) {
            Some(how) => parser.prim(how, "/", 1)?,
            None if word == "reorder" => parser.reorder()?,
            None => return Err(parser.wrong("`def`, `over` or `class` was expected")),
        }
    }
    Ok(parser.layer)
}

fn specifier(word: &str) -> Option<Specifier> {
    match word {
        "def" => Some(Specifier::Def),
        "over" => Some(Specifier::Over),
        "class" => Some(Specifier::Class),
        _ => None,
    }
}

/// How a list is edited, if the word says so.
fn edit(word: &str) -> Option<Edit> {
    match word {
        "prepend" => Some(Edit::Prepend),
        "append" | "add" => Some(Edit::Append),
        "delete" => Some(Edit::Delete),
        "reorder" => Some(Edit::Reorder),
        _ => None,
    }
}

struct Parser<'t> {
    text: &'t str,
    at: usize,
    layer: Layer,
}

impl<'t> Parser<'t> {
    /// Things of a list, or one alone; none by `None`.
    fn several<T>(&mut self, mut one: impl FnMut(&mut Self) -> Result<T>) -> Result<Vec<T>> {
        if self.takes(b'[') {
            let mut all = Vec::new();
            while !self.takes(b']') {
                all.push(one(self)?);
                self.takes(b',');
            }
            return Ok(all);
        }
        if self.peek() == Some(b'N') {
            self.word()?;
            return Ok(Vec::new());
        }
        Ok(vec![one(self)?])
    }

    fn path(&mut self, at: &str) -> Result<String> {
        if self.peek() != Some(b'<') {
            return Err(self.wrong("a path was expected, such as `</World>`"));
        }
        Ok(absolute(at, &self.between("<", ">")?))
    }

    fn reference(&mut self, at: &str) -> Result<Reference> {
        let mut found = Reference::default();
        if self.peek() == Some(b'@') {
            found.asset = self.asset()?;
        }
        if self.peek() == Some(b'<') {
            let path = self.between("<", ">")?;
            found.path = if path.is_empty() { path } else { absolute(at, &path) };
        } else if found.asset.is_empty() {
            return Err(self.wrong("a file or a path was expected"));
        }
        found.offset = self.offset()?;
        Ok(found)
    }

    /// What may stand in brackets behind a file.
    fn offset(&mut self) -> Result<Offset> {
        let mut found = Offset::default();
        if self.takes(b'(') {
            while !self.takes(b')') {
                let word = self.word()?;
                if word == "dictionary" {
                    continue;
                }
                self.expect(b'=')?;
                match (word, self.value()?) {
                    ("offset", Value::Numbers(v)) => found.offset = v.values.first().copied().unwrap_or(0.0),
                    ("scale", Value::Numbers(v)) => found.scale = v.values.first().copied().unwrap_or(1.0),
                    _ => {}
                }
                let _ = self.takes(b';') || self.takes(b',');
            }
        }
        Ok(found)
    }

    /// Words and their texts in braces: which variants are chosen.
    fn choices(&mut self) -> Result<Vec<(String, String)>> {
        let mut found = Vec::new();
        self.expect(b'{')?;
        while !self.takes(b'}') {
            self.word()?;
            let set = if matches!(self.peek(), Some(b'"' | b'\'')) {
                self.string()?
            } else {
                self.word()?.to_owned()
            };
            self.expect(b'=')?;
            found.push((set, self.string()?));
            let _ = self.takes(b';') || self.takes(b',');
        }
        Ok(found)
    }

    fn spec(&mut self, path: &str) -> &mut Spec {
        self.layer.prims.entry(path.to_owned()).or_default()
    }

    /// What is said of a layer or a prim, in brackets.
    fn metadata(&mut self, path: &str) -> Result<()> {
        self.expect(b'(')?;
        while !self.takes(b')') {
            if matches!(self.peek(), Some(b'"' | b'\'')) {
                self.string()?;
                continue;
            }
            let mut key = self.word()?;
            let how = edit(key);
            if how.is_some() {
                key = self.word()?;
            }
            let how = how.unwrap_or(Edit::Set);
            self.expect(b'=')?;
            match key {
                "references" | "payload" => {
                    let items = self.several(|p| p.reference(path))?;
                    let spec = self.spec(path);
                    let to = if key == "payload" { &mut spec.payloads } else { &mut spec.references };
                    to.add(how, items);
                }
                "inherits" | "specializes" => {
                    let items = self.several(|p| p.path(path))?;
                    let spec = self.spec(path);
                    let to = if key == "inherits" { &mut spec.inherits } else { &mut spec.specializes };
                    to.add(how, items);
                }
                "variantSets" | "apiSchemas" => {
                    let items = self.several(Self::string)?;
                    let spec = self.spec(path);
                    let to = if key == "apiSchemas" { &mut spec.schemas } else { &mut spec.variant_sets };
                    to.add(how, items);
                }
                "variants" => {
                    let chosen = self.choices()?;
                    self.spec(path).selections.extend(chosen);
                }
                "subLayers" => {
                    let layers = self.several(|p| {
                        if p.peek() != Some(b'@') {
                            return Err(p.wrong("a file was expected, such as `@set.usda@`"));
                        }
                        Ok((p.asset()?, p.offset()?))
                    })?;
                    self.layer.sub_layers.extend(layers);
                }
                _ => {
                    let value = self.value()?;
                    if path == "/" {
                        self.layer.say(key, &value);
                    } else {
                        self.spec(path).say(key, &value);
                    }
                }
            }
            let _ = self.takes(b';') || self.takes(b',');
        }
        Ok(())
    }

    fn reorder(&mut self) -> Result<()> {
        self.word()?;
        self.expect(b'=')?;
        self.value().map(|_| ())
    }

    /// A prim, behind the word that says how it is there.
    fn prim(&mut self, how: Specifier, parent: &str, depth: usize) -> Result<()> {
        let type_name = match self.peek() {
            Some(b'"' | b'\'') => "",
            _ => self.word()?,
        };
        let begins = self.at;
        let name = self.string()?;
        let path = join(parent, &name);
        if depth > DEEPEST || path.len() > LONGEST || name.is_empty() || name.contains(['/', '{', '.', '<']) {
            self.at = begins;
            return Err(self.wrong("the prim's name is none, or it is too deep within others"));
        }
        if !self.layer.prims.contains_key(&path) {
            self.spec(parent).children.push(name);
        }
        let spec = self.spec(&path);
        spec.specifier = how;
        spec.type_name = type_name.to_owned();
        if self.peek() == Some(b'(') {
            self.metadata(&path)?;
        }
        self.body(&path, depth)
    }

    /// What is in a prim or a variant.
    fn body(&mut self, path: &str, depth: usize) -> Result<()> {
        self.expect(b'{')?;
        while !self.takes(b'}') {
            if self.takes(b';') {
                continue;
            }
            let start = self.at;
            let word = self.word()?;
            if let Some(how) = specifier(word) {
                self.prim(how, path, depth + 1)?;
            } else if word == "variantSet" {
                self.variants(path, depth + 1)?;
            } else {
                let start = if word == "reorder" {
                    let next = self.word()?;
                    if matches!(next, "nameChildren" | "properties") {
                        self.expect(b'=')?;
                        self.value()?;
                        continue;
                    }
                    start
                } else {
                    start
                };
                self.at = start;
                self.property(path)?;
            }
        }
        Ok(())
    }

    fn variants(&mut self, path: &str, depth: usize) -> Result<()> {
        let set = self.string()?;
        self.expect(b'=')?;
        self.expect(b'{')?;
        while !self.takes(b'}') {
            let name = self.string()?;
            let inside = format!("{path}{{{set}={name}}}");
            if depth > DEEPEST || inside.len() > LONGEST {
                return Err(self.wrong("variants are too deep within others"));
            }
            self.spec(&inside);
            if self.peek() == Some(b'(') {
                self.metadata(&inside)?;
            }
            self.body(&inside, depth)?;
        }
        Ok(())
    }

    fn property(&mut self, path: &str) -> Result<()> {
        let mut how = Edit::Set;
        let mut type_name = self.word()?;
        while let Some(next) = Some(type_name)
            .filter(|w| matches!(*w, "custom" | "uniform" | "varying" | "config") || edit(w).is_some())
        {
            how = edit(next).unwrap_or(how);
            type_name = self.word()?;
        }
        if self.takes(b'[') {
            self.expect(b']')?;
        }
        let name = self.word()?.to_owned();
        let part = if self.byte() == Some(b'.') {
            self.at += 1;
            self.word()?
        } else {
            ""
        };
        let mut property = self.spec(path).properties.remove(&name).unwrap_or_default();
        if self.takes(b'=') {
            self.said(path, &mut property, (type_name, part), how)?;
        }
        if self.peek() == Some(b'(') {
            self.about(&mut property)?;
        }
        self.spec(path).properties.insert(name, property);
        Ok(())
    }

    /// What stands behind a property's equals sign.
    fn said(
        &mut self,
        path: &str,
        property: &mut Property,
        (type_name, part): (&str, &str),
        how: Edit,
    ) -> Result<()> {
        match (type_name, part) {
            ("rel", _) | (_, "connect") => {
                let targets = self.several(|p| p.path(path))?;
                property.targets.add(how, targets);
            }
            (_, "timeSamples") => {
                self.expect(b'{')?;
                while !self.takes(b'}') {
                    let time = self.number()?;
                    self.expect(b':')?;
                    let value = typed(self.value()?, type_name);
                    property.samples.push((time, value));
                    self.takes(b',');
                }
                property.samples.retain(|(time, _)| time.is_finite());
                property.samples.sort_by(|a, b| a.0.total_cmp(&b.0));
            }
            (_, "" | "default") => property.value = Some(typed(self.value()?, type_name)),
            _ => drop(self.value()?),
        }
        Ok(())
    }

    /// What is said of a property, in brackets.
    fn about(&mut self, property: &mut Property) -> Result<()> {
        self.expect(b'(')?;
        while !self.takes(b')') {
            if matches!(self.peek(), Some(b'"' | b'\'')) {
                self.string()?;
                continue;
            }
            let mut key = self.word()?;
            if edit(key).is_some() {
                key = self.word()?;
            }
            self.expect(b'=')?;
            match (key, self.value()?) {
                ("interpolation", Value::Text(text)) => property.interpolation = Some(text),
                ("colorSpace", Value::Text(text)) => property.color_space = Some(text),
                ("weight", Value::Numbers(Numbers { values, .. })) => {
                    property.weight = values.first().copied()
                }
                ("bindMaterialAs", Value::Text(text)) => property.is_strong = text == STRONG,
                _ => {}
            }
            let _ = self.takes(b';') || self.takes(b',');
        }
        Ok(())
    }
}

/// A value of that type: whole numbers hold between times, and quaternions are told with their real part first.
fn typed(value: Value, type_name: &str) -> Value {
    let Value::Numbers(Numbers { width, values, .. }) = value else { return value };
    let kind = match type_name {
        "quath" | "quatf" | "quatd" => Kind::Turn,
        "bool" | "uchar" | "int" | "uint" | "int64" | "uint64" | "int2" | "int3" | "int4" => Kind::Whole,
        _ => Kind::Real,
    };
    if kind == Kind::Turn && width == 4 {
        let single = |v: f64| if type_name == "quatd" { v } else { f64::from(v as f32) };
        let turned = values.chunks_exact(4).flat_map(|q| [q[1], q[2], q[3], q[0]].map(single)).collect();
        return Value::numbers(4, turned, kind);
    }
    // Numbers of single precision have it, however they are written.
    let is_single = type_name.starts_with("float") || type_name.ends_with('f');
    if is_single {
        return Value::numbers(width, values.iter().map(|v| f64::from(*v as f32)).collect(), kind);
    }
    Value::Numbers(Numbers { width, values, kind })
}

#[cfg(test)]
mod tests {
    use super::*;

    fn layer(body: &str) -> Layer {
        read(&format!("#usda 1.0\n{body}")).unwrap_or_else(|w| panic!("{w:?}"))
    }

    #[test]
    fn a_layer_is_read_with_all_that_may_stand_in_it() {
        let layer = layer(
            r#"(
                "a remark"
                defaultPrim = "World"
                metersPerUnit = 0.01
                upAxis = "Z"
                subLayers = [@a.usda@ (offset = 10; scale = 2), @b.usda@]
                customLayerData = { string who = "me"; dictionary deep = { int[] a = [1, 2] } }
            )
            def Xform "World" (
                prepend references = [@c.usd@</C> (offset = 3), </Here>]
                variants = { string look = "red" }
                prepend variantSets = "look"
                kind = "component" # for a browser
            )
            {
                reorder nameChildren = ["b", "a"]
                custom uniform token note = "x"
                float3[] points = [(0, 1, 2), (3, -4.5e1, inf)] (interpolation = "vertex")
                quatf q = (1, 2, 3, 4)
                double a.timeSamples = { 0: 1, 24: None, 12: 2, }
                rel material:binding = <../Mat> (bindMaterialAs = "strongerThanDescendants")
                color3f inputs:c.connect = </Mat/S.outputs:rgb>
                asset file = @@@a@b.png@@@
                string s = '''two
lines'''
                variantSet "look" = {
                    "red" { over "Seat" { bool on = true } }
                    "blue" (payload = None) { }
                }
                def "Seat" { /* empty */ }
            }"#,
        );
        assert_eq!(layer.about.default_prim, "World");
        assert_eq!((layer.about.meters_per_unit, layer.about.up_axis.as_deref()), (Some(0.01), Some("Z")));
        assert_eq!(layer.sub_layers[0], ("a.usda".to_owned(), Offset { offset: 10.0, scale: 2.0 }));
        let world = &layer.prims["/World"];
        assert_eq!((world.specifier, world.type_name.as_str()), (Specifier::Def, "Xform"));
        assert_eq!(world.references.prepended[1].path, "/Here");
        assert_eq!(world.selections["look"], "red");
        let value = |name: &str| world.properties[name].value.clone().unwrap();
        let Value::Numbers(points) = value("points") else { panic!("numbers") };
        assert_eq!((points.width, &points.values[3..5]), (3, &[3.0, -45.0][..]));
        assert_eq!(value("q"), Value::numbers(4, vec![2.0, 3.0, 4.0, 1.0], Kind::Turn));
        assert_eq!(value("file"), Value::Text("a@b.png".to_owned()));
        assert_eq!(value("s"), Value::Text("two\nlines".to_owned()));
        let times: Vec<f64> = world.properties["a"].samples.iter().map(|s| s.0).collect();
        assert_eq!(times, [0.0, 12.0, 24.0]);
        assert_eq!(world.properties["material:binding"].targets.explicit.as_ref().unwrap(), &["/Mat"]);
        assert!(layer.prims["/World{look=red}Seat"].properties.contains_key("on"));
        assert_eq!(world.children, ["Seat"]);
    }

    #[test]
    fn what_is_wrong_is_told_with_its_place() {
        let problem = |text: &str| read(text).unwrap_err();
        assert!(problem("nothing").problem.contains("#usda"));
        assert_eq!(problem("#usda 1.0\ndef \"A\" { float a = }").at, 30);
        for text in
            ["def \"A", "def \"A\" {", "def \"A\" ( a = { ) {}", "def \"A\" { float[] a = [(1, 2), 3] }"]
        {
            assert!(read(&format!("#usda 1.0\n{text}")).is_err(), "{text}");
        }
        // What is deep doesn't take the stack.
        assert!(read(&format!("#usda 1.0\n{}", "def \"A\" {".repeat(100_000))).is_err());
        assert!(read(&format!("#usda 1.0\n( a = {}", "{ a b = ".repeat(100_000))).is_err());
        assert!(read(&format!("#usda 1.0\ndef \"A\" {{ float a = {}", "(".repeat(100_000))).is_err());
    }

    #[test]
    fn no_text_that_is_cut_off_anywhere_breaks_it() {
        let text = "#usda 1.0\n( a = \"é\" )\ndef A \"B\" ( references = @x@</Y> ) { rel r = [</A>, <../B>] token[] t = [\"a\"] }";
        for end in (0..text.len()).filter(|end| text.is_char_boundary(*end)) {
            let _ = read(&text[..end]);
        }
    }
}
