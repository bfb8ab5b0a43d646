//! Documents of MaterialX (`.mtlx`) as layers: what `usdMtlx` makes of them, as a text of USD, which is read like any other.
//!
//! Each `surfacematerial` becomes a `Material` below `/MaterialX/Materials`, with all nodes that it leads to in it: so a reference to that path brings
//! them along, whatever else is in the document. Looks, assignments and definitions of nodes are left out.

use std::collections::BTreeMap;
use std::fmt::Write as _;

use roxmltree::{Document, Node, ParsingOptions};

/// What is wrong with a document, and at which byte.
pub(super) struct Wrong {
    pub at: usize,
    pub problem: String,
}

/// The longest text that is made of a document, in bytes: materials may share nodes, of which each gets its own.
const MOST: usize = 64 << 20;

/// Nodes that lead to one another.
const MOST_NODES: usize = 256;

/// Whether a text is one.
pub(super) fn is_one(text: &str) -> bool {
    text.trim_start_matches('\u{feff}').trim_start().starts_with('<')
}

/// The text of a layer.
pub(super) fn as_layer(text: &str) -> Result<String, Wrong> {
    let wrong = |problem: String| Wrong { at: 0, problem };
    let options = ParsingOptions { nodes_limit: 1_000_000, ..ParsingOptions::default() };
    let document = Document::parse_with_options(text, options).map_err(|e| {
        let at = e.pos();
        let lines = text.split('\n').take(at.row.saturating_sub(1) as usize);
        Wrong {
            at: lines.map(|line| line.len() + 1).sum::<usize>(),
            problem: format!("the document of MaterialX is no XML: {e}"),
        }
    })?;
    let root = document.root_element();
    if !root.has_tag_name("materialx") {
        return Err(wrong("it is neither a layer of USD nor a document of MaterialX".to_owned()));
    }
    let named: BTreeMap<&str, Node<'_, '_>> =
        elements(root).filter_map(|n| Some((n.attribute("name")?, n))).collect();
    let mut made = String::from(
        "#usda 1.0\n( defaultPrim = \"MaterialX\" )\ndef \"MaterialX\" {\ndef \"Materials\" {\n",
    );
    for material in elements(root).filter(|n| n.has_tag_name("surfacematerial")) {
        let mut writer = Writer { made: &mut made, named: &named, wanted: Vec::new() };
        writer.material(material);
        if made.len() > MOST {
            return Err(wrong(format!("the document makes more than {MOST} bytes of materials")));
        }
    }
    made.push_str("}\n}\n");
    Ok(made)
}

fn elements<'a, 'i>(of: Node<'a, 'i>) -> impl Iterator<Item = Node<'a, 'i>> {
    of.children().filter(|n| n.is_element())
}

/// A material under way.
struct Writer<'w, 'a, 'i> {
    made: &'w mut String,
    /// What stands in the document itself, by name.
    named: &'w BTreeMap<&'a str, Node<'a, 'i>>,
    /// Nodes and graphs that are needed in the material, in the order in which they were met.
    wanted: Vec<Node<'a, 'i>>,
}

impl<'a, 'i> Writer<'_, 'a, 'i> {
    fn material(&mut self, material: Node<'a, 'i>) {
        let path =
            format!("/MaterialX/Materials/{}", legal(material.attribute("name").unwrap_or("material")));
        let Some(shader) = elements(material)
            .find(|n| n.attribute("name") == Some("surfaceshader"))
            .and_then(|input| self.named.get(input.attribute("nodename")?).copied())
        else {
            return;
        };
        let name = path.rsplit('/').next().unwrap_or_default();
        self.wanted.push(shader);
        let called = legal(shader.attribute("name").unwrap_or_default());
        let _ = writeln!(
            self.made,
            "def Material \"{name}\" {{\ntoken outputs:mtlx:surface.connect = <{path}/{called}.outputs:surface>"
        );
        let mut next = 0;
        while let Some(node) = self.wanted.get(next).copied().filter(|_| next < MOST_NODES) {
            self.node(node, &path, 0);
            next += 1;
        }
        self.made.push_str("}\n");
    }

    /// A node, or a graph with the nodes in it, within a prim.
    fn node(&mut self, node: Node<'a, 'i>, scope: &str, depth: usize) {
        let name = legal(node.attribute("name").unwrap_or_default());
        let tag = node.tag_name().name();
        if tag == "nodegraph" {
            if depth > 0 {
                return;
            }
            let _ = writeln!(self.made, "def NodeGraph \"{name}\" {{");
            let inside = format!("{scope}/{name}");
            for child in elements(node) {
                match child.tag_name().name() {
                    "output" => {
                        let output = legal(child.attribute("name").unwrap_or("out"));
                        let kind = kind(child.attribute("type").unwrap_or_default());
                        if let Some(from) = self.source(child, &inside, true) {
                            let _ = writeln!(self.made, "{kind} outputs:{output}.connect = <{from}>");
                        }
                    }
                    "input" => self.input(child, scope, false),
                    _ => self.node(child, &inside, depth + 1),
                }
            }
            self.made.push_str("}\n");
            return;
        }
        let outputs = if node.attribute("type") == Some("surfaceshader") { "surface" } else { "out" };
        let id = match tag {
            "UsdUVTexture" => "ND_UsdUVTexture".to_owned(),
            _ => format!("ND_{}_{}", legal(tag), legal(node.attribute("type").unwrap_or_default())),
        };
        let _ = writeln!(
            self.made,
            "def Shader \"{name}\" {{\nuniform token info:id = \"{id}\"\ntoken outputs:{outputs}"
        );
        for input in elements(node).filter(|n| n.has_tag_name("input")) {
            self.input(input, scope, depth > 0);
        }
        self.made.push_str("}\n");
    }

    /// An input: what it is, or where that comes from.
    fn input(&mut self, input: Node<'a, 'i>, scope: &str, is_in_graph: bool) {
        let Some(name) = input.attribute("name").map(legal) else { return };
        let said = input.attribute("type").unwrap_or_default();
        let kind = kind(said);
        if let Some(from) = self.source(input, scope, is_in_graph) {
            let _ = writeln!(self.made, "{kind} inputs:{name}.connect = <{from}>");
            return;
        }
        let Some(value) = input.attribute("value") else { return };
        let numbers = || -> Option<String> {
            let all: Vec<f64> = value
                .split([',', ' '])
                .filter(|v| !v.is_empty())
                .map(|v| v.parse().ok())
                .collect::<Option<_>>()?;
            let all: Vec<String> = all.iter().filter(|v| v.is_finite()).map(f64::to_string).collect();
            match all.as_slice() {
                [] => None,
                [one] => Some(one.clone()),
                some => Some(format!("({})", some.join(", "))),
            }
        };
        let value = match said {
            "boolean" => Some(if value.trim() == "true" { "1" } else { "0" }.to_owned()),
            "integer" | "float" | "color3" | "color4" | "vector2" | "vector3" | "vector4" => numbers(),
            "filename" => {
                let prefix = input.ancestors().find_map(|n| n.attribute("fileprefix"));
                // Some names have it in them, since USD once took no notice of it.
                let is_whole = |prefix: &&str| value.starts_with('/') || value.starts_with(*prefix);
                let prefix = prefix.filter(|prefix| !is_whole(prefix)).unwrap_or_default();
                // Numbers of tiles are called otherwise in USD.
                let file = format!("{prefix}{value}").replace("<udim>", "<UDIM>").replace('@', "");
                let space = self.space(input);
                Some(format!("@{}@ ( colorSpace = \"{space}\" )", file.replace(['\n', '\r'], "")))
            }
            _ => Some(format!("\"{}\"", quoted(value))),
        };
        if let Some(value) = value {
            let _ = writeln!(self.made, "{kind} inputs:{name} = {value}");
        }
    }

    /// In which colour space the numbers of a file are: as it says or what it is in, and as they are where it isn't of colours.
    fn space(&self, input: Node<'a, 'i>) -> String {
        let is_colour = input
            .parent()
            .and_then(|node| node.attribute("type"))
            .is_some_and(|kind| kind.starts_with("color"));
        let said = if is_colour {
            input.ancestors().find_map(|n| n.attribute("colorspace"))
        } else {
            input.attribute("colorspace")
        };
        legal(said.unwrap_or(if is_colour { "lin_rec709" } else { "raw" }))
    }

    /// The output that an input is led from, by its path: a node's or a graph's, or an input of the graph that it is in.
    fn source(&mut self, input: Node<'a, 'i>, scope: &str, is_in_graph: bool) -> Option<String> {
        if let Some(graph) = input.attribute("nodegraph") {
            let node = *self.named.get(graph)?;
            self.want(node);
            let above = if is_in_graph { scope.rsplit_once('/')?.0 } else { scope };
            let output = input.attribute("output").map(legal).or_else(|| {
                let first = elements(node).find(|n| n.has_tag_name("output"))?;
                first.attribute("name").map(legal)
            })?;
            return Some(format!("{above}/{}.outputs:{output}", legal(graph)));
        }
        if let Some(name) = input.attribute("interfacename") {
            return is_in_graph.then(|| format!("{scope}.inputs:{}", legal(name)));
        }
        let name = input.attribute("nodename")?;
        if !is_in_graph {
            let node = *self.named.get(name)?;
            self.want(node);
        }
        Some(format!(
            "{scope}/{}.outputs:{}",
            legal(name),
            input.attribute("output").map_or("out".into(), legal)
        ))
    }

    fn want(&mut self, node: Node<'a, 'i>) {
        if !self.wanted.contains(&node) {
            self.wanted.push(node);
        }
    }
}

/// The type of a value, by MaterialX's name.
fn kind(said: &str) -> &'static str {
    match said {
        "float" => "float",
        "integer" | "boolean" => "int",
        "color3" => "color3f",
        "color4" => "color4f",
        "vector2" => "float2",
        "vector3" => "float3",
        "vector4" => "float4",
        "filename" => "asset",
        "string" => "string",
        _ => "token",
    }
}

/// A name that a path may have.
fn legal(name: &str) -> String {
    let mut name: String =
        name.chars().take(256).map(|c| if c.is_ascii_alphanumeric() { c } else { '_' }).collect();
    if name.is_empty() || name.starts_with(|c: char| c.is_ascii_digit()) {
        name.insert(0, '_');
    }
    name
}

/// A text within quotes.
fn quoted(text: &str) -> String {
    text.chars()
        .filter(|c| !c.is_control())
        .flat_map(|c| matches!(c, '"' | '\\').then_some('\\').into_iter().chain([c]))
        .collect()
}
