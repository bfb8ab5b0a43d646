//! The table by which pixels of pictures become spectra.

use crate::{Failure, root};
use straal_color::spectrum::uplift::{Uplift, UpliftTable};

/// Where the table is kept.
const FILE: &str = "crates/color/data/uplift.bin";

/// Works the table out and writes it; with the word `check`, says whether it is what is kept.
pub fn run(words: &[String]) -> Result<bool, Failure> {
    let path = root().join(FILE);
    let table = UpliftTable::made(&Uplift::new());
    match words {
        [] => {
            std::fs::write(&path, table)?;
            println!("{FILE}");
            Ok(true)
        }
        [word] if word == "check" => {
            let same = std::fs::read(&path)? == table;
            println!(
                "{FILE} {}",
                if same { "is as it is worked out" } else { "DIFFERS from what is worked out" }
            );
            Ok(same)
        }
        _ => Err("uplift-table takes nothing, or `check`".into()),
    }
}
