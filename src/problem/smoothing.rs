//! The widths over which loads are smooth.

use crate::contacts::default_width;
use crate::quantity::Quantity;
use crate::schema::Document;
use crate::schema::loads::Load;

/// Halves the widths of stops, contacts, cables, friction and drag. Returns whether there are any.
pub(super) fn halve(document: &mut Document) -> bool {
    let mut found = false;
    for load in document.loads.values_mut() {
        let widths: Vec<&mut Quantity> = match load {
            Load::Stop(own) => vec![&mut own.width],
            Load::Contact(own) => {
                let width = default_width(own);
                let friction = own.friction.as_mut().map(|friction| &mut friction.width);
                let width = own.width.get_or_insert(width);
                std::iter::once(width).chain(friction).collect()
            }
            Load::Cable(own) => vec![&mut own.width],
            Load::Friction(own) => vec![&mut own.width],
            Load::Drag(own) => vec![&mut own.width],
            Load::Bushing(own) => {
                let friction = own.friction.as_mut();
                friction.map_or(Vec::new(), |own| vec![&mut own.width, &mut own.load_width])
            }
            Load::Force(_)
            | Load::Torque(_)
            | Load::Spring(_)
            | Load::TorsionSpring(_)
            | Load::Damping(_)
            | Load::Controller(_)
            | Load::Pressure(_)
            | Load::Area(_)
            | Load::Edge(_)
            | Load::Line(_) => Vec::new(),
        };
        for width in widths {
            *width = width.times(0.5);
            found = true;
        }
    }
    found
}
