//! Random changes of files with structures and flexible bodies, none of which may make the program panic:
//! `cargo bench --bench mutations -- COUNT SEED` prints a table, and each file that panics.

#[path = "../tests/reference/mutations.rs"]
mod mutations;

use mutations::{Outcome, Random, mutated, sound, tried};
use std::panic::{AssertUnwindSafe, catch_unwind};

fn main() {
    let mut numbers = std::env::args().filter_map(|word| word.parse::<u64>().ok());
    let count = numbers.next().unwrap_or(2000);
    let mut random = Random(
        numbers
            .next()
            .unwrap_or(1)
            .wrapping_mul(0x9E37_79B9_7F4A_7C15)
            | 1,
    );
    let files = sound();
    let mut table = vec![[0; 4]; files.len()];
    for k in 0..count as usize {
        let which = k % files.len();
        let document = mutated(&files[which], &mut random);
        let outcome = catch_unwind(AssertUnwindSafe(|| tried(&document)));
        let column = match outcome {
            Ok(Outcome::Refused) => 0,
            Ok(Outcome::Failed) => 1,
            Ok(Outcome::Analysed) => 2,
            Err(_) => {
                println!("panic: {document}");
                3
            }
        };
        table[which][column] += 1;
    }
    println!("| file | refused | failed with a reason | analysed | panicked |");
    println!("|---|---|---|---|---|");
    for (file, row) in files.iter().zip(&table) {
        let [refused, failed, analysed, panicked] = row;
        println!(
            "| {} | {refused} | {failed} | {analysed} | {panicked} |",
            file["name"]
        );
    }
    let panicked: usize = table.iter().map(|row| row[3]).sum();
    if panicked > 0 {
        std::process::exit(1);
    }
}
