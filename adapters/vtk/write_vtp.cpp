#include "vtk/write_vtp.h"

#include <limits>
#include <ostream>

#include "vasohex/core/atomic_file.h"
#include "vasohex/skeleton/straighten.h"

namespace vasohex {

void write_vtp(const Skeleton& skeleton, const std::string& path) {
  const std::vector<PointChain> branches = split(skeleton);
  AtomicFile file(path);
  std::ostream& out = file.stream();
  out.precision(std::numeric_limits<double>::max_digits10);
  const auto array = [&](const char* type, const char* name, const char* more, auto&& values) {
    out << "<DataArray type=\"" << type << "\" Name=\"" << name << "\"" << more << " format=\"ascii\">\n";
    values();
    out << "</DataArray>\n";
  };
  out << "<?xml version=\"1.0\"?>\n<VTKFile type=\"PolyData\" version=\"1.0\" "
         "byte_order=\"LittleEndian\">\n<PolyData>\n"
      << "<Piece NumberOfPoints=\"" << skeleton.points.size() << "\" NumberOfVerts=\"0\" NumberOfLines=\""
      << branches.size() << "\" NumberOfStrips=\"0\" NumberOfPolys=\"0\">\n<PointData Scalars=\"Radius\">\n";
  array("Float64", "Radius", "", [&] {
    for (const double r : skeleton.radii) {
      out << r << '\n';
    }
  });
  out << "</PointData>\n<CellData>\n";
  array("Int32", "branch", "", [&] {
    for (std::size_t b = 0; b < branches.size(); ++b) {
      out << b << '\n';
    }
  });
  out << "</CellData>\n<Points>\n";
  array("Float64", "Points", " NumberOfComponents=\"3\"", [&] {
    for (const Vec3& p : skeleton.points) {
      out << p.x() << ' ' << p.y() << ' ' << p.z() << '\n';
    }
  });
  out << "</Points>\n<Lines>\n";
  array("Int64", "connectivity", "", [&] {
    for (const PointChain& branch : branches) {
      for (const int i : branch) {
        out << i << ' ';
      }
      out << '\n';
    }
  });
  array("Int64", "offsets", "", [&] {
    std::size_t end = 0;
    for (const PointChain& branch : branches) {
      out << (end += branch.size()) << '\n';
    }
  });
  out << "</Lines>\n</Piece>\n</PolyData>\n</VTKFile>\n";
  file.commit();
}

}  // namespace vasohex
