#include "span_energy.h"

#include <cmath>
#include <complex>

#include "lanes.h"

namespace vibro_impact::core
{
namespace
{
double form(const Eigen::VectorXd& coefficients, const Eigen::VectorXd& z)
{
  return dot(coefficients.data(), z.data(), z.size());
}
}  // namespace

void SpanEnergy::tabulate(const LinearState& linear, const Eigen::VectorXd& kick)
{
  const Eigen::Index size = kick.size();
  const Eigen::Index half = size / 2;
  drive_forms_ = Eigen::MatrixXd::Zero(size, 4);
  for (Eigen::VectorXd* table : {&squares_, &participation_, &integral_, &damping_, &kicked_, &kicks_})
  {
    *table = Eigen::VectorXd::Zero(size);
  }
  products_ = Eigen::VectorXd::Zero(half);
  compliance_ = lag_ = drag_ = 0.0;
  for (Eigen::Index n = 0; n < linear.size(); ++n)
  {
    const double frequency = linear.frequency(n);
    const double ratio = linear.damping_ratio(n);
    const double participation = linear.participation(n);
    if (frequency == 0.0)
    {
      continue;
    }
    const double decay = ratio * frequency;
    const std::complex<double> lambda(-decay, frequency * std::sqrt(1.0 - ratio * ratio));
    const double deflection = participation / (frequency * frequency);
    if (decay > 0.0)
    {
      // 2 delta (Re(lambda z^2) - |lambda z|^2/delta)/4
      squares_(n) = 0.5 * (decay * lambda.real() - frequency * frequency);
      squares_(half + n) = 0.5 * (-decay * lambda.real() - frequency * frequency);
      products_(n) = -decay * lambda.imag();
    }
    const std::complex<double> integral = participation / lambda;
    participation_(n) = participation;
    integral_(n) = integral.real();
    integral_(half + n) = -integral.imag();
    damping_(n) = 4.0 * decay * deflection;
    compliance_ += participation * deflection;
    lag_ += participation * 2.0 * ratio * deflection / frequency;
    drag_ += 2.0 * decay * deflection * deflection;
  }
  // A kick by x changes the quadratic part P by  P(z + x) - P(z) = P(x) + (grad P(x)).z.
  kicked_ = damping_ - 2.0 * squares_.cwiseProduct(kick);
  kicked_.head(half) -= products_.cwiseProduct(kick.tail(half));
  kicked_.tail(half) -= products_.cwiseProduct(kick.head(half));
  integral_of_kick_ = form(integral_, kick);
  damping_of_kick_ = form(damping_, kick);
  squares_of_kick_ = quadratic(kick);
}

void SpanEnergy::tabulateHarmonic(const LinearState& linear, double frequency, double amplitude,
                                  const Eigen::ArrayXd& transfer_re, const Eigen::ArrayXd& transfer_im)
{
  // With y = sum of terms c e^(lambda t):  integral Re(y) Re(d) dt = 1/2 Re integral y (d + d*) dt,  and
  //   Re(z (p d + r d*)) = Re d Re((p + r) z) - Im d Im((p - r) z)
  harmonic_ = true;
  const std::complex<double> i_omega(0.0, frequency);
  const Eigen::Index half = squares_.size() / 2;
  const auto set =
      [half, this](Eigen::Index column, Eigen::Index n, std::complex<double> with, std::complex<double> against)
  {
    const std::complex<double> sum = with + against;
    const std::complex<double> difference = with - against;
    drive_forms_(n, column) = sum.real();
    drive_forms_(half + n, column) = -sum.imag();
    drive_forms_(n, column + 1) = -difference.imag();
    drive_forms_(half + n, column + 1) = -difference.real();
  };
  std::complex<double> admittance = 0.0;
  std::complex<double> dissipation = 0.0;
  double rate = 0.0;
  for (Eigen::Index n = 0; n < linear.size(); ++n)
  {
    const double participation = linear.participation(n);
    if (linear.frequency(n) == 0.0 || participation == 0.0)
    {
      continue;
    }
    const double decay = linear.damping_ratio(n) * linear.frequency(n);
    const std::complex<double> lambda(-decay,
                                      linear.frequency(n) * std::sqrt(1.0 - std::pow(linear.damping_ratio(n), 2)));
    const std::complex<double> transfer(transfer_re(n), transfer_im(n));
    const std::complex<double> velocity = i_omega * transfer;
    set(0, n, -0.5 * participation * lambda / (lambda + i_omega), -0.5 * participation * lambda / (lambda - i_omega));
    set(2, n, 2.0 * decay * lambda * velocity / (lambda + i_omega),
        2.0 * decay * lambda * std::conj(velocity) / (lambda - i_omega));
    admittance += participation * transfer;
    dissipation += 0.5 * decay * velocity * velocity / i_omega;
    rate += decay * std::norm(velocity);
  }
  work_drive_re_ = -0.25 * admittance.real();
  work_drive_im_ = 0.25 * admittance.imag();
  work_rate_ = -0.5 * amplitude * amplitude * (i_omega * admittance).real();
  dissipation_drive_re_ = dissipation.real();
  dissipation_drive_im_ = -dissipation.imag();
  dissipation_rate_ = amplitude * amplitude * rate;
}

void SpanEnergy::open(const Eigen::VectorXd& z, const Moment& now)
{
  start_ = antiderivatives(z, now);
  kicks_.setZero();
  passed_ = Passed();
}

SpanEnergy::Amounts SpanEnergy::upTo(const Eigen::VectorXd& z, const Moment& now) const
{
  Amounts amounts = antiderivatives(z, now);
  amounts.work -= start_.work;
  amounts.dissipated -= start_.dissipated;
  if (!harmonic_)
  {
    amounts.work +=
        lag_ * passed_.squared_slope - form(integral_, kicks_) - 0.5 * integral_of_kick_ * passed_.squared_changes;
    amounts.dissipated += drag_ * passed_.squared_slope + form(kicked_, kicks_) +
                          (0.5 * damping_of_kick_ - squares_of_kick_) * passed_.squared_changes;
  }
  return amounts;
}

SpanEnergy::Amounts SpanEnergy::antiderivatives(const Eigen::VectorXd& z, const Moment& now) const
{
  if (harmonic_)
  {
    const double square_re = now.drive_re * now.drive_re - now.drive_im * now.drive_im;
    const double square_im = 2.0 * now.drive_re * now.drive_im;
    const auto [work_re, work_im, dissipation_re, dissipation_im] =
        evaluateFourForms(drive_forms_.data(), z.data(), z.size());
    return {now.drive_re * work_re + now.drive_im * work_im + work_drive_re_ * square_re + work_drive_im_ * square_im +
                work_rate_ * now.time + now.body_energy,
            quadratic(z) + now.drive_re * dissipation_re + now.drive_im * dissipation_im +
                dissipation_drive_re_ * square_re + dissipation_drive_im_ * square_im + dissipation_rate_ * now.time};
  }
  const double a = now.acceleration;
  const double s = now.slope;
  return {s * form(integral_, z) - a * form(participation_, z) + 0.5 * compliance_ * a * a - lag_ * a * s +
              s * s * (lag_ * now.time - 0.5 * integral_of_kick_) + now.body_energy,
          quadratic(z) - s * form(damping_, z) + s * s * (0.5 * damping_of_kick_ + drag_ * now.time)};
}

double SpanEnergy::quadratic(const Eigen::VectorXd& z) const
{
  const Eigen::Index half = z.size() / 2;
  return quadraticForm(z.data(), squares_.data(), products_.data(), half);
}

}  // namespace vibro_impact::core
