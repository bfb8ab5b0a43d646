//! Scenes of glTF 2.0.

use straal_scene::{Diagnostic, Span};

use super::{Means, Translated};

/// Reads one.
pub(super) fn read(name: &str, _bytes: &[u8], means: &mut Means<'_>) -> Option<Translated> {
    let message = format!("`{name}` is a scene of glTF 2.0, which is not supported yet");
    means.d.push(Diagnostic::error(Span::NONE, message));
    None
}
