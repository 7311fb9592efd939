//! Contacts.

use super::Checker;
use crate::contacts::{HERTZ, MOST, spheres};
use crate::finding::Finding;
use crate::math::Vec3;
use crate::model::HeightField as Field;
use crate::placement::GROUND;
use crate::pointer::join;
use crate::quantity::values;
use crate::schema::contacts::{Contact, HeightField, Surface};
use crate::schema::joints::Ends;

impl Checker<'_> {
    /// Checks a contact: its bodies and its surface.
    pub(super) fn contact(&mut self, pointer: &str, contact: &Contact) {
        let list = join(pointer, "between");
        self.between(&list, &contact.between);
        if contact.between[0] == GROUND && contact.between[1] != GROUND {
            let expected =
                "the body with the sphere or point; ground comes second, with the surface";
            self.fault(Finding::new(join(&list, 0), "\"ground\"", expected));
        }
        if let Ends::Each(pair) = &contact.at {
            self.pair(&join(pointer, "at"), &contact.between, pair);
        }
        let place = join(pointer, "surface");
        match &contact.surface {
            Surface::Plane { normal } => {
                self.direction(&join(&join(&place, "plane"), "normal"), normal);
            }
            Surface::Sphere { radius } => {
                if radius.value == 0.0 && contact.radius.value == 0.0 {
                    let expected = "a radius of one of them, as two points do not meet";
                    let radius = join(&join(&place, "sphere"), "radius");
                    self.fault(Finding::new(radius, "a point against a point", expected));
                }
            }
            Surface::Capsule { half, .. } => {
                self.direction(&join(&join(&place, "capsule"), "half"), half);
            }
            Surface::Box { size, radius } => {
                for (k, own) in size.iter().enumerate() {
                    if own.value <= 2.0 * radius.value {
                        let found = format!("{}, with a \"radius\" of {}", own.value, radius.value);
                        let place = join(&join(&join(&place, "box"), "size"), k);
                        let expected = "an edge longer than twice the radius";
                        self.fault(Finding::new(place, found, expected));
                    }
                }
            }
            Surface::HeightField(own) => {
                let around = contact.wheel.as_ref().map_or(0.0, |own| own.radius.value);
                let radius = around + contact.radius.value;
                self.heights(&join(&place, "height_field"), own, radius);
            }
        }
        self.shape(pointer, contact);
        self.stiffness_of(pointer, contact);
        if let Some(friction) = &contact.friction
            && let Some(own) = &friction.stribeck
            && own.coefficient.value < friction.coefficient.value
        {
            let found = format!(
                "{}, below the sliding {}",
                own.coefficient.value, friction.coefficient.value
            );
            let place = join(&join(&join(pointer, "friction"), "stribeck"), "coefficient");
            self.fault(Finding::new(
                place,
                found,
                "at least the sliding coefficient",
            ));
        }
    }

    /// Checks what touches the surface of a contact.
    fn shape(&mut self, pointer: &str, contact: &Contact) {
        let has_spheres = matches!(
            contact.surface,
            Surface::Plane { .. } | Surface::HeightField(_)
        );
        if contact.spheres.is_some() && (contact.half.is_none() || !has_spheres) {
            let found = "spheres of what is no capsule on a plane or height field";
            let expected = "\"half\" and such a surface";
            self.fault(Finding::new(join(pointer, "spheres"), found, expected).of_key());
        }
        if let Some(wheel) = &contact.wheel {
            let wheels = join(pointer, "wheel");
            self.direction(&join(&wheels, "axis"), &wheel.axis);
            if !has_spheres {
                let found = "a wheel on another surface than a plane or height field";
                let expected = "one of them; spheres and points touch all surfaces";
                self.fault(Finding::new(wheels, found, expected).of_key());
            }
        }
        if let Some(half) = &contact.half {
            let place = join(pointer, "half");
            self.direction(&place, half);
            if contact.wheel.is_some() {
                let found = "a capsule that is a wheel";
                self.fault(Finding::new(&place, found, "\"half\" or \"wheel\"").of_key());
            }
            if contact.spheres.is_none() && spheres(contact, half) > MOST as usize {
                let expected = format!(
                    "\"spheres\": how many touch, as more than {MOST} would be no further apart than the radius"
                );
                self.fault(Finding::new(&place, "a long thin capsule", expected));
            }
            if contact.radius.value == 0.0 && !matches!(contact.surface, Surface::Plane { .. }) {
                let expected = "a radius, as its sides touch";
                let radius = join(pointer, "radius");
                self.fault(Finding::new(radius, "a capsule without one", expected));
            }
        }
    }

    /// Checks that a contact has a stiffness and a width, or materials that give them.
    fn stiffness_of(&mut self, pointer: &str, contact: &Contact) {
        let Some(names) = &contact.materials else {
            let given = [("stiffness", &contact.stiffness), ("width", &contact.width)];
            for (key, _) in given.iter().filter(|(_, own)| own.is_none()) {
                let found = format!("no \"{key}\"");
                let finding = Finding::new(pointer, found, format!("\"{key}\": a number"));
                let hint = "\"materials\" give those of spheres on planes and spheres".to_owned();
                self.fault(finding.hint(Some(hint)));
            }
            return;
        };
        let list = join(pointer, "materials");
        for (k, name) in names.iter().enumerate() {
            self.material(&join(&list, k), name);
        }
        if contact.stiffness.is_some() {
            let place = join(pointer, "stiffness");
            let found = "a stiffness beside \"materials\"";
            self.fault(Finding::new(place, found, "one of them").of_key());
        }
        if let Some(exponent) = contact.exponent.filter(|own| *own != HERTZ) {
            let found = format!("{exponent} beside \"materials\"");
            let expected = "1.5, that of Hertz, or a stiffness in place of materials";
            self.fault(Finding::new(join(pointer, "exponent"), found, expected));
        }
        let radii = match &contact.surface {
            Surface::Plane { .. } => Some([contact.radius.value, 1.0]),
            Surface::Sphere { radius } => Some([contact.radius.value, radius.value]),
            Surface::Capsule { .. } | Surface::Box { .. } | Surface::HeightField(_) => None,
        };
        let is_sphere = contact.wheel.is_none() && contact.half.is_none();
        if !is_sphere || radii.is_none_or(|radii| radii.contains(&0.0)) {
            let found = "materials of what is no sphere on a plane or sphere";
            let expected =
                "\"stiffness\" and \"width\": Hertz's formula is for spheres with a radius";
            self.fault(Finding::new(list, found, expected).of_key());
        }
    }

    /// Checks a height field: its grid, and that a sphere touches it at one place.
    fn heights(&mut self, place: &str, own: &HeightField, radius: f64) {
        let before = self.findings.len();
        self.direction(&join(place, "normal"), &own.normal);
        self.direction(&join(place, "direction"), &own.direction);
        let [n, d] = [&own.normal, &own.direction].map(|own| Vec3::from(values(own)));
        if n.cross(&d).norm() <= 1e-9 * n.norm() * d.norm() {
            let expected = "a direction across \"normal\"";
            let found = "a direction along the normal";
            self.fault(Finding::new(join(place, "direction"), found, expected));
        }
        for (key, all, least) in [("along", &own.along, 2), ("across", &own.across, 1)] {
            let list = join(place, key);
            if all.len() < least {
                let expected = format!("{least} or more");
                self.fault(Finding::new(
                    &list,
                    format!("{} places", all.len()),
                    expected,
                ));
            }
            if let Some(k) = all.windows(2).position(|pair| pair[1] <= pair[0]) {
                let found = format!("{} after {}", all[k + 1], all[k]);
                self.fault(Finding::new(
                    join(&list, k + 1),
                    found,
                    "places that increase",
                ));
            }
        }
        let list = join(place, "heights");
        if own.heights.len() != own.across.len() {
            let found = format!("{} rows", own.heights.len());
            let expected = format!("{}, one for each place \"across\"", own.across.len());
            self.fault(Finding::new(&list, found, expected));
        }
        for (k, row) in own.heights.iter().enumerate() {
            if row.len() != own.along.len() {
                let found = format!("{} heights", row.len());
                let expected = format!("{}, one for each place \"along\"", own.along.len());
                self.fault(Finding::new(join(&list, k), found, expected));
            }
        }
        if self.findings.len() > before {
            return;
        }
        let field = Field::new(own.along.clone(), own.across.clone(), &own.heights);
        let tightest = field.tightest();
        if radius >= tightest {
            let found = format!("heights with a hollow of the radius {tightest:.4} m");
            let expected = format!(
                "hollows wider than the sphere or wheel, whose radius is {radius} m, as it touches at one place"
            );
            self.fault(Finding::new(list, found, expected));
        }
    }
}
