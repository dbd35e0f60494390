// A surface as an estimator asks for it.
#pragma once
#include "../shared/vec3.hpp"

namespace pliant::estimation {

class Surface {
 public:
  virtual ~Surface() = default;
  // Signed distance [m] of a place, negative inside the material, and the outward unit normal nearest to it.
  // Whether it is asked in Python.
  virtual bool in_python() const { return false; }
  virtual double near(const Vec3& place, Vec3& normal) const = 0;
};

class Plane final : public Surface {
 public:
  Plane(const Vec3& origin, const Vec3& normal) : origin_(origin), normal_(normal) {}
  double near(const Vec3& place, Vec3& normal) const override {
    normal = normal_;
    return dot(normal_, place - origin_);
  }

 private:
  Vec3 origin_, normal_;
};

}  // namespace pliant::estimation
