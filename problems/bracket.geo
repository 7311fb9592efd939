// An angle bracket of three plates, in mm: a base with two bolt holes, an upright with a bore for a pin, and a
// rib between them. gmsh -2 bracket.geo -o bracket.msh
SetFactory("OpenCASCADE");
Rectangle(1) = {0, 0, 0, 60, 80};
Disk(11) = {42, 18, 0, 5};
Disk(12) = {42, 62, 0, 5};
BooleanDifference(2) = { Surface{1}; Delete; }{ Surface{11, 12}; Delete; };
Rectangle(3) = {0, 0, 0, 80, 80};
Disk(13) = {55, 40, 0, 10};
BooleanDifference(4) = { Surface{3}; Delete; }{ Surface{13}; Delete; };
Rotate {{0, 1, 0}, {0, 0, 0}, -Pi/2} { Surface{4}; }
Point(101) = {0, 40, 0};
Point(102) = {30, 40, 0};
Point(103) = {12, 40, 30};
Point(104) = {0, 40, 38};
Line(101) = {101, 102};
Line(102) = {102, 103};
Line(103) = {103, 104};
Line(104) = {104, 101};
Curve Loop(101) = {101, 102, 103, 104};
Plane Surface(101) = {101};
BooleanFragments{ Surface{2, 4, 101}; Delete; }{}
base() = Surface In BoundingBox {-1, -1, -1, 61, 81, 1};
upright() = Surface In BoundingBox {-1, -1, -1, 1, 81, 81};
rib() = Surface In BoundingBox {-1, 39, -1, 31, 41, 39};
Physical Surface("base") = base();
Physical Surface("upright") = upright();
Physical Surface("rib") = rib();
Physical Curve("bolts") = {Curve In BoundingBox {36, 12, -1, 48, 24, 1}, Curve In BoundingBox {36, 56, -1, 48, 68, 1}};
Physical Curve("bore") = {Curve In BoundingBox {-1, 29, 44, 1, 51, 66}};
Mesh.MeshSizeMax = 30;
Mesh.MeshSizeMin = 12;
Mesh.MeshSizeFromCurvature = 10;
Mesh.Algorithm = 8;
Mesh.RecombineAll = 1;
Mesh.SubdivisionAlgorithm = 1;
Mesh.ElementOrder = 2;
Mesh.HighOrderOptimize = 1;
