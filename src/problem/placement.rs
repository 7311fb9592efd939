//! Poses of the bodies at the start, and points and axes relative to them.

use super::elements;
use super::mass::mass_properties;
use super::turns::rotation;
use crate::math::rotation::{Quat, compose, matrix};
use crate::math::scalar::lift3;
use crate::math::{Mat3, Scalar, Vec3};
use crate::quantity::{Quantity, Vector, vector};
use crate::schema::Document;
use crate::schema::joints::{Axis, Ends};
use crate::schema::mechanics::{BodyPoint, Location, Point};

/// Message of a failed look-up. A checked file has all names.
const CHECKED: &str = "names are checked when a problem is read";

/// The name of the body that does not move.
pub const GROUND: &str = "ground";

/// Pose of a body.
#[derive(Clone, Copy, Debug)]
pub struct Pose<S> {
    /// Origin of the body's axes, ground axes \[m\].
    pub origin: Vec3<S>,
    /// Centre of mass from the origin, body axes \[m\].
    pub centre: Vec3<S>,
    /// Euler parameters, from body axes to ground.
    pub orientation: Quat<S>,
    /// Rotation matrix, from body axes to ground.
    pub rotation: Mat3<S>,
}

impl<S: Scalar> Pose<S> {
    /// The pose of ground.
    fn ground() -> Self {
        Self {
            origin: Vec3::zeros(),
            centre: Vec3::zeros(),
            orientation: [S::one(), S::zero(), S::zero(), S::zero()],
            rotation: Mat3::identity(),
        }
    }

    /// Centre of mass in ground axes \[m\].
    pub fn position(&self) -> Vec3<S> {
        self.origin + self.rotation * self.centre
    }
}

/// Splits `"body.point"` into body and point. Without a dot there is no point.
pub fn split_location(text: &str) -> (&str, Option<&str>) {
    match text.split_once('.') {
        Some((body, point)) => (body, Some(point)),
        None => (text, None),
    }
}

/// The bodies relative to which a body is placed.
pub fn placed_by<'a>(document: &'a Document, body: &str) -> impl Iterator<Item = &'a str> {
    let place = document.bodies.get(body).map(|body| &body.place);
    let at = place.and_then(|place| match &place.at {
        Some(Location::Named(name)) => Some(split_location(name).0),
        _ => None,
    });
    let turn = place.and_then(|place| place.relative_to.as_deref());
    at.into_iter().chain(turn).filter(|name| *name != GROUND)
}

/// An order of the bodies in which each comes after those relative to which it is placed.
///
/// # Errors
/// The names along a cycle; the last is the first again.
pub fn placement_order(document: &Document) -> Result<Vec<usize>, Vec<String>> {
    /// Visits `name` after the bodies that it depends on; `path` holds the unfinished names.
    fn visit(
        document: &Document,
        name: &str,
        path: &mut Vec<String>,
        order: &mut Vec<usize>,
    ) -> Result<(), Vec<String>> {
        let Some(index) = document.bodies.get_index_of(name) else {
            return Ok(());
        };
        if order.contains(&index) {
            return Ok(());
        }
        let first = path.iter().position(|waiting| waiting == name);
        path.push(name.to_owned());
        if let Some(first) = first {
            return Err(path.split_off(first));
        }
        for other in placed_by(document, name) {
            visit(document, other, path, order)?;
        }
        path.pop();
        order.push(index);
        Ok(())
    }
    let mut order = Vec::with_capacity(document.bodies.len());
    for name in document.bodies.keys() {
        visit(document, name, &mut Vec::new(), &mut order)?;
    }
    Ok(order)
}

/// All bodies of a checked document at the start of the design `x`.
pub struct Assembly<'a, S> {
    document: &'a Document,
    x: &'a [S],
    /// Poses in the order of the file.
    pub poses: Vec<Pose<S>>,
}

impl<'a, S: Scalar> Assembly<'a, S> {
    /// Places the bodies in `order`.
    pub fn new(document: &'a Document, order: &[usize], x: &'a [S]) -> Self {
        let mut assembly = Self {
            document,
            x,
            poses: vec![Pose::ground(); document.bodies.len()],
        };
        for &index in order {
            assembly.poses[index] = assembly.place(index);
        }
        assembly
    }

    /// What is written.
    pub fn document(&self) -> &'a Document {
        self.document
    }

    /// Pose of body `index`, after the bodies relative to which it is placed.
    fn place(&self, index: usize) -> Pose<S> {
        let (name, body) = self.document.bodies.get_index(index).expect(CHECKED);
        let place = &body.place;
        let mut orientation = self
            .pose(place.relative_to.as_deref().unwrap_or(GROUND))
            .orientation;
        // Each rotation is about fixed axes, so a later one multiplies from the left. The body
        // from which the turn starts comes last.
        let mut turn = Pose::ground().orientation;
        for one in place.turn.iter().flat_map(|turns| turns.list()) {
            turn = compose(&rotation(one, self.x), &turn);
        }
        orientation = compose(&orientation, &turn);
        let rotation = matrix(&orientation);
        let put = place
            .put
            .as_ref()
            .map_or(Vec3::zeros(), |point| self.in_body(name, point));
        let at = match &place.at {
            None => Vec3::zeros(),
            Some(Location::Named(text)) => self.named(text),
            Some(Location::Coordinates(point)) => vector(point, self.x),
        };
        Pose {
            origin: at - rotation * put,
            centre: mass_properties(body, self.x).centre,
            orientation,
            rotation,
        }
    }

    /// Index of a body; `None` is ground.
    pub fn index(&self, body: &str) -> Option<usize> {
        (body != GROUND).then(|| self.document.bodies.get_index_of(body).expect(CHECKED))
    }

    /// Pose of a body or ground.
    pub fn pose(&self, body: &str) -> Pose<S> {
        self.index(body)
            .map_or(Pose::ground(), |index| self.poses[index])
    }

    /// A named point of a body, from the origin of its axes \[m\].
    fn point(&self, name: &str, point: &str) -> Vec3<S> {
        let body = self.document.bodies.get(name).expect(CHECKED);
        match body.points.get(point) {
            Some(BodyPoint::Coordinates(point)) => return vector(point, self.x),
            Some(BodyPoint::Between(on)) => {
                let [a, b] = on.between.each_ref().map(|end| self.point(name, end));
                return a + (b - a) * on.fraction.get(self.x);
            }
            None => {}
        }
        if let Some(elements) = &body.elements {
            return lift3(&elements::place(self.document, elements, point));
        }
        if let Some(modal) = &body.modal {
            let point = modal.point(point).expect(CHECKED);
            return lift3(&point.position) * super::modal::scale(modal, self.x);
        }
        let beam = body.beam.as_ref().expect(CHECKED);
        let part = beam.station(point).expect(CHECKED).get(self.x);
        Vec3::new(part * beam.length.get(self.x), S::zero(), S::zero())
    }

    /// A point of a body or of ground, from the origin of its axes \[m\].
    pub fn in_body(&self, body: &str, point: &Point) -> Vec3<S> {
        match point {
            Point::Named(name) => self.point(body, name),
            Point::Coordinates(point) => vector(point, self.x),
        }
    }

    /// A named point in ground axes \[m\].
    pub fn named(&self, text: &str) -> Vec3<S> {
        let (body, _) = split_location(text);
        let pose = self.pose(body);
        pose.origin + pose.rotation * self.named_in_body(text)
    }

    /// A named point from the origin of the axes of its body \[m\].
    pub fn named_in_body(&self, text: &str) -> Vec3<S> {
        let (body, point) = split_location(text);
        point.map_or(Vec3::zeros(), |point| self.point(body, point))
    }

    /// A point given by its ground coordinates at the start, from the origin of the axes of a body
    /// or of ground \[m\].
    pub fn at_ground(&self, body: &str, point: &Vector) -> Vec3<S> {
        let pose = self.pose(body);
        pose.rotation.tr_mul(&(self.ground(point) - pose.origin))
    }

    /// An end of a rod or spring, from the centre of mass of its body (or from the origin) \[m\].
    pub fn end(&self, between: &[String; 2], at: &Ends, side: usize) -> Vec3<S> {
        let name = &between[side];
        let point = match at {
            Ends::Each(pair) => self.in_body(name, [&pair.a, &pair.b][side]),
            Ends::Ground(points) => self.at_ground(name, &points[side]),
        };
        point - self.pose(name).centre
    }

    /// Value of a number of the file at this design.
    pub fn quantity(&self, quantity: &Quantity) -> S {
        quantity.get(self.x)
    }

    /// Value of a vector of the file at this design.
    pub fn ground(&self, components: &Vector) -> Vec3<S> {
        vector(components, self.x)
    }

    /// Axis of a joint in ground axes; its length is that in the file.
    pub fn axis(&self, axis: &Axis) -> Vec3<S> {
        match axis {
            Axis::Ground(axis) => vector(axis, self.x),
            Axis::OfBody(of) => self.pose(&of.body).rotation * vector(&of.axis, self.x),
        }
    }
}
