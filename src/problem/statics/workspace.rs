//! Static and modal problems with one analysis each. Designs use them one after the other; there
//! are as many as designs are computed at a time.

use crate::structures::modes::ModalProblem;
use crate::structures::statics::StaticProblem;
use std::fmt;
use std::sync::{Arc, Mutex};

/// Matrices of one design at a time.
#[derive(Default)]
pub struct Workspace {
    /// For load cases; made when it is needed first.
    pub statics: Option<StaticProblem>,
    /// For frequencies; made when it is needed first.
    pub modal: Option<ModalProblem>,
}

/// Workspaces that no design uses at present.
#[derive(Clone, Default)]
pub struct Workspaces(Arc<Mutex<Vec<Workspace>>>);

impl Workspaces {
    /// One that is free, or a new one.
    pub fn take(&self) -> Workspace {
        let free = self.0.lock().ok().and_then(|mut all| all.pop());
        free.unwrap_or_default()
    }

    /// Gives one back.
    pub fn give(&self, workspace: Workspace) {
        if let Ok(mut all) = self.0.lock() {
            all.push(workspace);
        }
    }
}

impl fmt::Debug for Workspaces {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str("Workspaces")
    }
}
