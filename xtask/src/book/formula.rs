//! Formulas: TeX to MathML, which browsers draw by themselves.

use pulldown_latex::config::{DisplayMode, RenderConfig};
use pulldown_latex::{Parser, Storage, push_mathml};

/// A formula as MathML; within a line, or in one of its own.
pub fn mathml(tex: &str, block: bool) -> Result<String, String> {
    if tex.contains(r"\operatorname") {
        return Err(format!(r"the formula {tex}: GitHub refuses \operatorname; write \mathrm"));
    }
    let storage = Storage::new();
    let display_mode = if block { DisplayMode::Block } else { DisplayMode::Inline };
    let mut out = String::new();
    for event in Parser::new(tex, &storage) {
        event.map_err(|e| format!("the formula {tex}: {e}"))?;
    }
    push_mathml(
        &mut out,
        Parser::new(tex, &storage),
        RenderConfig { display_mode, ..RenderConfig::default() },
    )
    .map_err(|e| format!("the formula {tex}: {e}"))?;
    // pulldown-latex 0.8 puts the space before `\cos^2` inside of the script, where it counts as what the script belongs to.
    for script in ["msup", "msub", "msubsup", "munder", "mover", "munderover"] {
        let (open, space) = (format!("<{script}>"), "<mspace width=\"0.1667em\" />");
        out = out.replace(&format!("{open}{space}"), &format!("{space}{open}"));
    }
    Ok(out.replace("&amp;nbsp;", "\u{a0}"))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn formulas_become_mathml_and_wrong_ones_errors() {
        let fraction = mathml(r"\frac{a}{b}", true).unwrap();
        assert!(fraction.contains("<mfrac>") && fraction.contains("display=\"block\""), "{fraction}");
        let power = mathml(r"2\cos^e\theta\ x", false).unwrap();
        assert!(power.contains("<msup><mi>cos</mi><mi>e</mi></msup>") && !power.contains("amp"), "{power}");
        assert!(mathml(r"\frac{a}", false).is_err());
        assert!(mathml(r"\nonsense", false).is_err());
        assert!(mathml(r"\operatorname{mean} x", false).is_err());
    }
}
