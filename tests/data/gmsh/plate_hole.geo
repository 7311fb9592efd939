// A plate of 300 × 100 mm with a hole of radius 20 mm. gmsh -2 plate_hole.geo -o plate_hole.msh
SetFactory("OpenCASCADE");
Rectangle(1) = {-150, -50, 0, 300, 100};
Disk(2) = {0, 0, 0, 20};
BooleanDifference(3) = { Surface{1}; Delete; }{ Surface{2}; Delete; };
Physical Curve("left") = {Curve In BoundingBox {-151, -51, -1, -149, 51, 1}};
Physical Curve("right") = {Curve In BoundingBox {149, -51, -1, 151, 51, 1}};
Physical Curve("hole") = {Curve In BoundingBox {-21, -21, -1, 21, 21, 1}};
Physical Point("corner") = {Point In BoundingBox {-151, -51, -1, -149, -49, 1}};
Physical Surface("plate") = {3};
Mesh.MeshSizeMax = 34;
Mesh.MeshSizeMin = 2;
Mesh.MeshSizeFromCurvature = 24;
Mesh.Algorithm = 8;
Mesh.RecombineAll = 1;
Mesh.SubdivisionAlgorithm = 1;
Mesh.ElementOrder = 2;
Mesh.HighOrderOptimize = 1;
