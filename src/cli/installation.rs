//! What an installation brings along: completions of shells, the manual page.

use super::arguments::Arguments;
use super::{DONE, Failure, print};
use clap::CommandFactory;
use clap_complete::Shell;

const PROGRAM: &str = "optimize";

/// Prints completions for a shell.
pub(crate) fn completions(shell: Shell) -> Result<u8, Failure> {
    let mut text = Vec::new();
    clap_complete::generate(shell, &mut Arguments::command(), PROGRAM, &mut text);
    print(&String::from_utf8_lossy(&text))?;
    Ok(DONE)
}

/// Prints the manual page, with a section for each command.
pub(crate) fn manual() -> Result<u8, Failure> {
    let mut text = Vec::new();
    let program = Arguments::command();
    clap_mangen::Man::new(program.clone())
        .render(&mut text)
        .map_err(Failure::numerical)?;
    for command in program.get_subcommands().filter(|own| !own.is_hide_set()) {
        let page = clap_mangen::Man::new(command.clone());
        let name = format!("{PROGRAM} {}", command.get_name());
        text.extend(format!(".SH \"{}\"\n", name.to_uppercase()).bytes());
        page.render_description_section(&mut text)
            .and_then(|()| page.render_options_section(&mut text))
            .map_err(Failure::numerical)?;
    }
    print(&String::from_utf8_lossy(&text))?;
    Ok(DONE)
}
