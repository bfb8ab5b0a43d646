//! The lab's report as a page for a browser: one file, no script, nothing from elsewhere.

use super::pictures::{self, CostPictures};
use super::table::{LINES, whole};
use super::volumes::{Inequality, Volumes};
use super::{Report, base64, text};
use crate::false_colour::Chart;
use std::fmt::Write;

/// The page. `title` is the scene's name.
pub fn html(r: &Report, title: &str) -> String {
    let title = escaped(title);
    let mut out = format!(
        "<!doctype html>\n<html lang=\"en\">\n<head>\n<meta charset=\"utf-8\">\n\
         <meta name=\"viewport\" content=\"width=device-width\">\n\
         <title>Search structures on {title}</title>\n<style>\n{STYLE}</style>\n</head>\n<body>\n\
         <h1>Search structures on {title}</h1>\n<p>{}</p>\n",
        escaped(text::rays(r).trim())
    );
    out += &table(r);
    let notes = text::notes(r);
    let _ = writeln!(out, "<pre>{}</pre>", escaped(notes.trim()));
    if let Some(pictures) = &r.pictures {
        out += &figures(pictures);
    }
    out += &volumes(&r.volumes);
    let _ = write!(
        out,
        "<h2>If an object moves</h2>\n<pre>{}</pre>\n<h2>What the lines mean</h2>\n<dl>\n",
        escaped(text::moving(&r.moving).trim())
    );
    for (section, label, meaning) in text::meanings() {
        let _ = writeln!(out, "<dt>{section}: {label}</dt><dd>{}</dd>", escaped(meaning));
    }
    let _ = write!(out, "</dl>\n<p>straal {}</p>\n</body>\n</html>\n", straal::VERSION);
    out
}

const STYLE: &str = "\
body { font: 15px/1.45 system-ui, sans-serif; margin: 2em auto; max-width: 72em; padding: 0 1em; color: #202020; }
h1 { font-size: 1.5em; } h2 { font-size: 1.15em; margin-top: 2em; }
table { border-collapse: collapse; font-variant-numeric: tabular-nums; }
div.wide { overflow-x: auto; }
th, td { padding: .15em .7em; text-align: right; white-space: nowrap; }
th:first-child, td:first-child { text-align: left; }
tr.section th { padding-top: .8em; color: #666; font-weight: normal; border-bottom: 1px solid #ccc; }
td.left, th.left { text-align: left; }
.pays { color: #17662c; } .no { color: #8a3b12; }
pre { white-space: pre-wrap; background: #f5f5f5; padding: .7em; }
figure { display: inline-block; margin: 0 1em 1em 0; vertical-align: top; }
figure img { image-rendering: pixelated; display: block; }
figcaption { max-width: 256px; }
dt { font-weight: bold; } dd { margin: 0 0 .4em 1.5em; }
";

fn table(r: &Report) -> String {
    let mut out = String::from("<div class=\"wide\"><table>\n<tr><th></th>");
    for row in &r.rows {
        let _ =
            write!(out, "<th>{}</th>", escaped(&row.name).replacen(':', ":<br>", 1).replace(',', ",<br>"));
    }
    out += "</tr>\n";
    let mut section = None;
    for line in LINES {
        if section != Some(line.section) {
            section = Some(line.section);
            let columns = r.rows.len() + 1;
            let _ = writeln!(
                out,
                "<tr class=\"section\"><th colspan=\"{columns}\">{}</th></tr>",
                line.section.title()
            );
        }
        let _ = write!(out, "<tr><td title=\"{}\">{}</td>", escaped(line.meaning), line.label);
        for row in &r.rows {
            let _ = write!(out, "<td>{}</td>", escaped(&line.cell(row, r)));
        }
        out += "</tr>\n";
    }
    out + "</table></div>\n"
}

fn figures(p: &CostPictures) -> String {
    let mut out = String::from("<h2>Where rays are expensive</h2>\n");
    for picture in &p.each {
        let mean =
            picture.tests.iter().map(|&t| f64::from(t)).sum::<f64>() / picture.tests.len().max(1) as f64;
        let coarse = match picture.block {
            1 => String::new(),
            n => format!("; one ray for {n} x {n} pixels"),
        };
        let _ = writeln!(
            out,
            "<figure>{}<figcaption>{}: {} on average{coarse}</figcaption></figure>",
            image(&picture.chart(p.scale), &picture.name),
            escaped(&picture.name),
            super::table::figures(mean)
        );
    }
    let legend = Chart::legend(512, p.scale, pictures::CAPTION);
    let _ = writeln!(out, "<p>{}</p>", image(&legend, "the scale of all pictures"));
    out
}

fn image(chart: &Chart, alt: &str) -> String {
    let mut png = Vec::new();
    // Writing to memory can't fail; a picture that isn't there would be seen.
    let _ = chart.write_png(&mut png, &[]);
    format!(
        "<img alt=\"{}\" width=\"{}\" height=\"{}\" src=\"data:image/png;base64,{}\">",
        escaped(alt),
        chart.width,
        chart.height,
        base64::encode(&png)
    )
}

fn volumes(v: &Volumes) -> String {
    let mut out = String::from(
        "<h2>Does a box around it pay?</h2>\n<p>cost<sub>BV</sub> + p cost<sub>group</sub> &lt; cost<sub>group</sub>, \
         with p the share of rays that cross the box.</p>\n<div class=\"wide\"><table>\n<tr><th>object</th>\
         <th>primitives</th><th>p</th><th class=\"left\">tests, one by one</th><th class=\"left\">ns, one by one</th>\
         <th class=\"left\">ns, in a tree of its own</th></tr>\n",
    );
    let cell = |i: &Inequality| {
        format!("<td class=\"left {0}\">{1}: {0}</td>", text::pays(i), escaped(&text::sides(i)))
    };
    for w in &v.rows {
        let _ = write!(out, "<tr><td>{}</td><td>{}</td>", escaped(&w.name), whole(w.primitives));
        match &w.bounded {
            None => {
                out += "<td>-</td><td class=\"left\" colspan=\"3\">nothing bounds it: no box holds it</td>"
            }
            Some(b) => {
                let _ = write!(out, "<td>{:.3}</td>", b.crossing);
                out.extend([&b.tests, &b.time, &b.tree_time].map(cell));
            }
        }
        out += "</tr>\n";
    }
    out += "</table></div>\n";
    if v.left_out > 0 {
        let _ = writeln!(out, "<p>And {} objects with fewer primitives.</p>", v.left_out);
    }
    out
}

/// Text that means itself in HTML.
fn escaped(text: &str) -> String {
    text.replace('&', "&amp;").replace('<', "&lt;").replace('>', "&gt;").replace('"', "&quot;")
}

#[cfg(test)]
mod tests {
    #[test]
    fn text_means_itself() {
        assert_eq!(super::escaped("<a href=\"x\">&"), "&lt;a href=&quot;x&quot;&gt;&amp;");
    }
}
