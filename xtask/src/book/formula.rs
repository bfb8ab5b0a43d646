//! Formulas: TeX to MathML, which browsers draw by themselves.

use pulldown_latex::config::{DisplayMode, RenderConfig};
use pulldown_latex::{Parser, Storage, push_mathml};

/// A formula as MathML; within a line, or in one of its own.
pub fn mathml(tex: &str, block: bool) -> Result<String, String> {
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
    Ok(out)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn formulas_become_mathml_and_wrong_ones_errors() {
        let fraction = mathml(r"\frac{a}{b}", true).unwrap();
        assert!(fraction.contains("<mfrac>") && fraction.contains("display=\"block\""), "{fraction}");
        assert!(mathml(r"\frac{a}", false).is_err());
        assert!(mathml(r"\nonsense", false).is_err());
    }
}
